"""Tables of propositions: what is read, and what is refused with its place."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.kernel.tables import InputError, read_rows
from monitors.kernel.verdicts import Truth


def rows(text: str, *names: str) -> list[tuple[Truth, ...]]:
    return list(read_rows(text.splitlines(keepends=True), names, "t.csv"))


PQ: list[tuple[Truth, ...]] = [(True, False), (None, True)]


@pytest.mark.parametrize(
    "text",
    [
        "p,q\n1,0\n,1\n",
        "p,q\ntrue,FALSE\n,True",
        "q,p\r\n0,1\r\n1,\r\n",
        "\ufeffp,q\n1,0\n,1\n",
        "\ufeff\r\np,q\r\n1,0\r\n,1\r\n",
        "tick,p,q\n0,1,0\n1,,1\n",
        "tick,p,q\n7,1,0\n8,,1\n",
        " p , q \n 1 , 0 \n , 1 \n",
        '"p","q"\n"1","0"\n"","1"\n',
        "p,other,q\n1,x,0\n,,1\n",
        '{"p": true, "q": 0}\n{"p": null, "q": "1"}\n',
        '{"p": 1, "q": false, "tick": 3}\n\n{"p": "", "q": true, "tick": 4}\n',
        '\ufeff{"p": 1, "q": 0}\n{"p": null, "q": 1}\n',
    ],
)
def test_a_table_is_read_row_by_row(text: str) -> None:
    assert rows(text, "p", "q") == PQ


def test_a_proposition_may_be_named_tick() -> None:
    assert rows("tick\n1\n0\n", "tick") == [(True,), (False,)]


def test_an_empty_value_is_unknown_in_a_table_of_one_column_too() -> None:
    assert rows("q\n1\n\n0\n", "q") == [(True,), (None,), (False,)]


def test_a_name_with_a_comma_is_one_column() -> None:
    assert rows('"f(x,y)",q\n1,0\n', "f(x,y)", "q") == [(True, False)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "t.csv: the trace is empty"),
        ("\n \n", "t.csv: the trace is empty"),
        ("\n\np,q\n1,0\n\n1\n", "t.csv:6: 1 values for 2 columns"),
        ('\n{"p": 1, "q": 1}\n[1]\n', "t.csv:3: a line must hold one object"),
        (
            '{"p":1,"q":0,"tick":0}\n{"p":1,"q":0}\n{"p":0,"q":1,"tick":1}\n',
            "t.csv:2: some rows have a `tick` and some have none",
        ),
        (
            '{"p":1,"q":0}\n{"p":1,"q":0,"tick":4}\n',
            "t.csv:2: some rows have a `tick` and some have none",
        ),
        ("tick,p,q,tick\n0,1,0,5\n", "t.csv:1: there are two columns `tick`"),
        ("tick,p,q\n1_0,1,0\n", "t.csv:2: column `tick`: `1_0` is no whole number"),
        ("p\n1\n", "t.csv:1: there is no column `q`; there are p"),
        ("p,q,q\n1,0,0\n", "t.csv:1: there are two columns `q`"),
        (
            "p,q\n1,2\n",
            "t.csv:2: column `q`: `2` is no truth value; write 0, 1, true, false, or nothing for "
            "unknown",
        ),
        (
            "p,q\n1,0\nnan,0\n",
            "t.csv:3: column `p`: `nan` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        ("p,q\n1\n", "t.csv:2: 1 values for 2 columns"),
        ("tick,p,q\n0,1,0\n0,1,0\n", "t.csv:3: column `tick` goes back: 0, then 0"),
        ("tick,p,q\n5,1,0\n4,1,0\n", "t.csv:3: column `tick` goes back: 5, then 4"),
        ("tick,p,q\n0,1,0\n2,1,0\n", "t.csv:3: column `tick` leaves ticks out: 0, then 2"),
        ("tick,p,q\n0.5,1,0\n", "t.csv:2: column `tick`: `0.5` is no whole number"),
        ("tick,p,q\n,1,0\n", "t.csv:2: column `tick`: `` is no whole number"),
        ('p,q\n"1,0\n', "t.csv:2: unexpected end of data"),
        ('{"p": 1}\n', "t.csv:1: there is no column `q`; there are p"),
        ('{"p": 1, "q": 1}\n[1, 1]\n', "t.csv:2: a line must hold one object"),
        (
            '{"p": 1, "q": NaN}\n',
            "t.csv:1: column `q`: `nan` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (
            '{"p": 1, "q": [1]}\n',
            "t.csv:1: column `q`: `[1]` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (
            '{"p": 1, "q": 1, "tick": 2}\n{"p": 1, "q": 1, "tick": 1}\n',
            "t.csv:2: column `tick` goes back: 2, then 1",
        ),
    ],
)
def test_a_table_that_cannot_be_read_says_why(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        rows(text, "p", "q")
    assert str(caught.value) == message


def test_a_tick_column_that_begins_to_fail_is_told_in_json_too() -> None:
    """A row without its tick may hide a gap."""
    with pytest.raises(InputError):
        rows('{"p": 1, "tick": 0}\n{"p": 1}\n{"p": 1, "tick": 5}\n', "p")


@pytest.mark.parametrize(
    "text",
    [
        '{"p": 1, "q": tru}\n',
        '{"p": 1, "q": 1\n',
        '{"p": 1, "q": 1, "p": 0}\n',
        '{"p": ' + "[" * 100_000 + "\n",
        '{"p": 1' + "0" * 5000 + ', "q": 1}\n',
        "p,q\n\x00,1\n",
        "p,q\n" + "1" * 200_000 + ",1\n",
        "tick,p,q\n" + "1" * 5000 + ",1,1\n",
        '{"p": true, "q": true, "tick": true}\n',
    ],
)
def test_a_hostile_table_is_an_input_error(text: str) -> None:
    with pytest.raises(InputError):
        rows(text, "p", "q")


@given(st.text(max_size=40))
def test_any_text_gives_rows_or_an_input_error(text: str) -> None:
    for table in (text, f"p,q\n{text}", f'{{"p": 1, "q": {text}}}'):
        try:
            found = rows(table, "p", "q")
        except InputError as error:
            complaint = str(error)
        else:
            complaint = "" if all(len(row) == 2 for row in found) else "\n"
        assert "\n" not in complaint


@given(st.lists(st.integers(-2, 3), min_size=1, max_size=6))
def test_ticks_grow_by_one_or_the_table_is_refused(ticks: list[int]) -> None:
    table = "tick,p\n" + "".join(f"{tick},1\n" for tick in ticks)
    if all(later == earlier + 1 for earlier, later in pairwise(ticks)):
        assert len(rows(table, "p")) == len(ticks)
    else:
        with pytest.raises(InputError):
            rows(table, "p")
