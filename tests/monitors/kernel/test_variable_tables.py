"""Tables of variables: what is read, and what is refused with its place."""

import math

import pytest

from monitors.kernel.tables import InputError
from monitors.kernel.variable_tables import read_variables
from monitors.kernel.variables import Value, Variable

VARIABLES = {
    "battery": Variable("battery", "number"),
    "docked": Variable("docked", "truth"),
    "mode": Variable("mode", "word", ("drive", "dock")),
}


def rows(text: str) -> list[tuple[Value, ...]]:
    return list(read_variables(text.splitlines(keepends=True), VARIABLES, "t.csv"))


@pytest.mark.parametrize(
    "text",
    [
        "battery,docked,mode\n17.5,1,drive\n,,\n",
        "mode,docked,battery,other\r\n drive ,true,+1.75e1,x\r\n,,nan,\r\n",
        "tick,battery,docked,mode\n4,17.5,TRUE,drive\n5,NaN,,\n",
        '{"battery": 17.5, "docked": true, "mode": "drive"}\n'
        '{"battery": null, "docked": null, "mode": null}\n',
        '{"battery": "17.5", "docked": 1, "mode": "drive", "tick": 1}\n'
        '{"battery": "", "docked": "", "mode": "", "tick": 2}\n',
    ],
)
def test_a_table_is_read_row_by_row(text: str) -> None:
    assert rows(text) == [(17.5, True, "drive"), (None, None, None)]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-3", -3),
        ("9007199254740993", 2**53 + 1),
        ("-9007199254740993", -(2**53) - 1),
        ("1" * 40, float("1" * 40)),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-400", 0.0),
        ("1e400", math.inf),
        ("-INF", -math.inf),
    ],
)
def test_a_number_is_what_is_written(text: str, value: float) -> None:
    ((found, _, _),) = rows(f"battery,docked,mode\n{text},,\n")
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "t.csv: the trace is empty"),
        ("battery,mode\n", "t.csv:1: there is no column `docked`; there are battery, mode"),
        (
            "battery,docked,mode\n1,,\n1_0,,\n",
            "t.csv:3: column `battery`: `1_0` is no number; write it as 17.5 or 1e-3, or nothing "
            "for unknown",
        ),
        (
            "battery,docked,mode\n\u0661,,\n",
            "t.csv:2: column `battery`: `\u0661` is no number; write it as 17.5 or 1e-3, or "
            "nothing for unknown",
        ),
        (
            '{"battery": true, "docked": 1, "mode": null}\n',
            "t.csv:1: column `battery`: `True` is no number; write it as 17.5 or 1e-3, or nothing "
            "for unknown",
        ),
        (
            "battery,docked,mode\n1,,Dock\n",
            "t.csv:2: column `mode`: `Dock` is none of its words; write drive, dock, or nothing "
            "for unknown",
        ),
        (
            "battery,docked,mode\n1,nan,\n",
            "t.csv:2: column `docked`: `nan` is no truth value; write 0, 1, true, false, or "
            "nothing for unknown",
        ),
        (
            "tick,battery,docked,mode\n1,1,,\n3,1,,\n",
            "t.csv:3: column `tick` leaves ticks out: 1, then 3",
        ),
        (
            '{"battery":1,"docked":0,"mode":null,"tick":0}\n{"battery":1,"docked":0,"mode":null}\n',
            "t.csv:2: some rows have a `tick` and some have none",
        ),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        rows(text)
    assert str(caught.value) == message


def test_a_word_is_read_to_the_letter_before_spaces_are_none_of_it() -> None:
    words = {"mode": Variable("mode", "word", ("dock", " dock", " ", "1"))}

    def read(text: str) -> list[tuple[Value, ...]]:
        return list(read_variables(text.splitlines(keepends=True), words, "t.csv"))

    assert read('mode\n" dock"\n"dock "\n" "\n1\n') == [(" dock",), ("dock",), (" ",), ("1",)]
    with pytest.raises(InputError, match="`1` is none of its words"):
        read('{"mode": 1}\n')
