"""Tables of propositions: what is read, and what is refused with its place."""

import io
import random
from itertools import pairwise
from unittest import mock

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from monitors.kernel import tables
from monitors.kernel.columns import columns_of, rows_of
from monitors.kernel.tables import InputError, placed_rows, read_pieces
from monitors.kernel.verdicts import Truth

Rows = list[tuple[Truth, ...]]


def rows(text: str, *names: str) -> Rows:
    pieces = read_pieces(io.StringIO(text, newline=""), names, "t.csv")
    ticks, columns = columns_of(pieces, len(names))
    return list(rows_of(columns, ticks))


PQ: Rows = [(True, False), (None, True)]


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
        '"p\n",q\n1,0\n,1\n',
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
        ('\n"p\n",q\n1,0\n1\n', "t.csv:5: 1 values for 2 columns"),
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


# Whole pieces ---------------------------------------------------------------------------------


def in_pieces(text: str, names: tuple[str, ...], characters: int) -> Rows | str:
    """The rows, or what is wrong, where a piece of the text has about so many characters."""
    with mock.patch.object(tables, "_CHARACTERS", characters):
        try:
            return rows(text, *names)
        except InputError as error:
            return str(error)


def row_by_row(text: str, names: tuple[str, ...]) -> Rows | str:
    """The same, where each value is looked at by itself."""
    try:
        lines = io.StringIO(text, newline="")
        return [
            tuple(tables._truth(row[name], name, place) for name in names)
            for place, row in placed_rows(lines, names, "t.csv")
        ]
    except InputError as error:
        return str(error)


DIGITS = ("0", "1")
PLAIN = ("", "", "0", "1", "true", "False", "TRUE", "false")
WORDS = ("", "0", "1", "true", "FALSE", " 1", "0 ", "\u2003", '"1"', '""', '" true"')
WRONG = (
    "2",
    "x",
    "01",
    "10",
    '"',
    '""1',
    '1"',
    '"0\n"',
    '"1\r\n,"',
    '"\n',
    "\0",
    "é",
    "true1",
    "0true",
    "truefalse",
    "tfalserue",
    "tru",
    "f1alse",
    "\u017false",
    "fal\u017fe",
    "\u0661",
    "a,b",
)
ENDS = ("\n", "\n", "\n", "\r\n", "\r", "\n\n", "\n\r\n", "\n \n", "")


@st.composite
def csv_tables(draw: st.DrawFn) -> tuple[str, tuple[str, ...]]:
    """A table of up to sixty rows with up to three faults, and what is read of it."""
    choose = draw(st.randoms(use_true_random=False))
    names = draw(st.sampled_from([("p",), ("p", "q"), ("q", "p"), (), ("tick",), ("p", "tick")]))
    header = [*names, *choose.choice([(), (), ("tick",), ("n",), ("tick", "n", "n")])]
    choose.shuffle(header)
    header = list(dict.fromkeys(header)) or ["n"]
    cells = choose.choice((DIGITS, PLAIN, PLAIN, WORDS, (*WORDS, "0\n0")))
    end = choose.choice(ENDS[:5])
    first = choose.choice((0, 0, 7, -3, 98, 10**18 - 5))
    table = [[choose.choice(cells) for _ in header] for _ in range(choose.randrange(60))]
    if "tick" in header and "tick" not in names:
        form = choose.choice(("{}", "{}", " {}", "{:03}", '"{}"'))
        for tick, row in enumerate(table, first):
            row[header.index("tick")] = form.format(tick)
    ends = [end] * len(table)
    for _ in range(choose.choice((0, 0, 1, 1, 2, 3)) if table else 0):
        spoil(table, ends, choose)
    lines = [",".join(row) + each for row, each in zip(table, ends, strict=True)]
    return ",".join(header) + "\n" + "".join(lines), names


def spoil(table: list[list[str]], ends: list[str], choose: random.Random) -> None:
    """Change one cell, the length of one row, its end, or the order of two rows."""
    place = choose.randrange(len(table))
    row = table[place]
    match choose.randrange(4):
        case 0 if row:
            row[choose.randrange(len(row))] = choose.choice((*WRONG, *WORDS))
        case 1:
            row[:] = choose.choice((row[1:], [*row, "1"], []))
        case 2:
            ends[place] = choose.choice(ENDS)
        case _:
            other = choose.randrange(len(table))
            table[place], table[other] = table[other], table[place]


@pytest.mark.slow
@given(csv_tables(), st.sampled_from([1, 2, 5, 16, 64, 1 << 14]))
@example(("p\n0\n\n1\n", ("p",)), 1)  # an empty line is a value, and not a line that is too much
@example(("p\n0\n\n", ("p",)), 64)
@example(("p,q\n\n1,true\n1,2\n", ("p", "q")), 1)  # an empty line counts in what comes after it
@example(("p,q\n1,0\n10,\n", ("p", "q")), 64)  # as long as two digits
@example(("p,q\n1,0\n2,1\n", ("p", "q")), 64)  # a digit that is no value
@example(("p,q\n1,\n2,1\n", ("p", "q")), 64)
@example(("p,q\n1,0\n3,1\n", ("p", "q")), 64)
@example(("p,q\n1,0\n1;0\n", ("p", "q")), 64)  # another separator
@example(("p,q\n1\n0,1,0\n", ("p", "q")), 64)  # as many cells as two rows have
@example(("p,q\n1,\n/,True\n", ("p", "q")), 64)
@example(("p,q\n,\n,,\n", ("p", "q")), 64)  # a row has more cells than the header
@example(("p,n,q\n,,\n,true,\n,,1\n", ("p", "q")), 1)
@example(("p\ntrue\n\nfalse\n", ("p",)), 64)
@example(("tick,p\n" + "9" * 18 + ",1\n" + "1" + "0" * 18 + ",1\n", ("p",)), 64)
@example(('p,q\n1,"0\n"\n1,0\n1,2\n', ("p", "q")), 3)  # a value that goes on in the next piece
def test_pieces_are_read_as_they_are_row_by_row(
    table: tuple[str, tuple[str, ...]], characters: int
) -> None:
    """The same rows, or the same words about the same place."""
    text, names = table
    assert in_pieces(text, names, characters) == row_by_row(text, names)


@pytest.mark.parametrize(
    "text",
    [
        "p,q\n" + "1,0\n" * 50,
        "q,n,p\r\n" + "1,0,1\r\n" * 50,
        "p,q\n" + "1,\n true ,FALSE\n" * 50,
        "p,q,n\n" + '"1",0,"a ""b"", c"\n\n' * 50,
        "tick,p,q\n" + "".join(f"{tick},1,\n" for tick in range(-20, 120)),
        "p, tick ,q\n" + "".join(f"1, {tick} ,0\n" for tick in range(95, 220)),
    ],
)
def test_what_is_sound_is_never_read_row_by_row(text: str) -> None:
    expected = row_by_row(text, ("p", "q"))
    with mock.patch.object(tables, "_csv_rows", side_effect=AssertionError):
        assert in_pieces(text, ("p", "q"), 64) == expected


def test_digits_are_not_even_split() -> None:
    with mock.patch.object(tables, "_codes", side_effect=AssertionError):
        assert rows("p,n,q\n" + "0,0,1\r\n" * 9 + "1,1,1", "p", "q") == [
            *[(False, True)] * 9,
            (True, True),
        ]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_words_and_empty_cells_are_not_split_either(end: str) -> None:
    lines = ["p,n,m,q", ",1,0,True", "FALSE,,,", ",,,", "1,0,false,0"]
    with mock.patch.object(tables, "_codes", side_effect=AssertionError):
        assert rows(end.join(lines), "p", "q") == [
            (None, True),
            (False, None),
            (None, None),
            (True, False),
        ]
