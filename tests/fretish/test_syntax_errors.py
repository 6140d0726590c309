"""What is said of a text that is no FRETish, and what to write instead: whole texts."""

import pytest

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import Sentence


def mistake_of(text: str) -> Diagnostic:
    found = parse(Source("r.fret", text).span())
    assert isinstance(found, Diagnostic), text
    return found


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "the sw shall within 3 satisfy p",
            "F108 a duration needs a unit\n"
            "  --> r.fret:1:23\n"
            "   | the sw shall within 3 satisfy p\n"
            "   |                       ^^^^^^^\n"
            "help: write ticks, or a unit of time: `within 3 seconds`, `within 500 ms`",
        ),
        (
            "the sw shall always satisfy v < 1e9999 m/s",
            "F308 the number has more than 60 digits, or an exponent of more than 3 digits\n"
            "  --> r.fret:1:33\n"
            "   | the sw shall always satisfy v < 1e9999 m/s\n"
            "   |                                 ^^^^^^\n"
            "help: write fewer digits",
        ),
        (
            "the sw shall within 3 msec satisfy p",
            "F108 a duration needs a unit, and `msec` is not one\n"
            "  --> r.fret:1:23\n"
            "   | the sw shall within 3 msec satisfy p\n"
            "   |                       ^^^^\n"
            "help: write `milliseconds`",
        ),
        (
            "the sw shall within 3 secnds satisfy p",
            "F108 a duration needs a unit, and `secnds` is not one\n"
            "  --> r.fret:1:23\n"
            "   | the sw shall within 3 secnds satisfy p\n"
            "   |                       ^^^^^^\n"
            "help: did you mean `seconds`?",
        ),
        (
            "the sw shall within 3 parsecs satisfy p",
            "F108 a duration needs a unit, and `parsecs` is not one\n"
            "  --> r.fret:1:23\n"
            "   | the sw shall within 3 parsecs satisfy p\n"
            "   |                       ^^^^^^^\n"
            "help: write ticks, or a unit of time: `within 3 seconds`, `within 500 ms`",
        ),
        (
            "the sw shall within n ticks satisfy p",
            "F108 a duration must begin with a number in digits\n"
            "  --> r.fret:1:21\n"
            "   | the sw shall within n ticks satisfy p\n"
            "   |                     ^\n"
            "help: write, for example, `within N seconds`",
        ),
        (
            "the sw shall for satisfy p",
            "F108 a duration must begin with a number in digits\n"
            "  --> r.fret:1:18\n"
            "   | the sw shall for satisfy p\n"
            "   |                  ^^^^^^^\n"
            "help: write, for example, `for N seconds`",
        ),
        (
            "globally the sw shall satisfy p",
            "F101 FRETish has no word for the scope `globally`\n"
            "  --> r.fret:1:1\n"
            "   | globally the sw shall satisfy p\n"
            "   | ^^^^^^^^\n"
            "help: remove it: without a scope a requirement applies to the whole run",
        ),
        (
            "in m & n the sw shall satisfy q",
            "F101 a mode must be one name\n"
            "  --> r.fret:1:6\n"
            "   | in m & n the sw shall satisfy q\n"
            "   |      ^\n"
            "help: for an expression, write `while p & q` instead of `in`",
        ),
        (
            "in x > 3 the sw shall satisfy q",
            "F101 a mode must be one name\n"
            "  --> r.fret:1:6\n"
            "   | in x > 3 the sw shall satisfy q\n"
            "   |      ^\n"
            "help: for an expression, write `while p & q` instead of `in`",
        ),
        (
            "the sw must satisfy q",
            "F107 a requirement uses `shall`, not `must`\n"
            "  --> r.fret:1:8\n"
            "   | the sw must satisfy q\n"
            "   |        ^^^^\n"
            "help: write `shall`",
        ),
        (
            "sw has satisfy q",
            "F107 a requirement uses `shall`, not `has`\n"
            "  --> r.fret:1:4\n"
            "   | sw has satisfy q\n"
            "   |    ^^^\n"
            "help: did you mean `shall`?",
        ),
        (
            "when p then the sw shall satisfy q",
            "F101 FRETish has no `then` after the condition\n"
            "  --> r.fret:1:8\n"
            "   | when p then the sw shall satisfy q\n"
            "   |        ^^^^\n"
            "help: remove `then`",
        ),
        (
            "in the m mode the sw shall satisfy q",
            "F101 a mode cannot contain `the`\n"
            "  --> r.fret:1:4\n"
            "   | in the m mode the sw shall satisfy q\n"
            "   |    ^^^\n"
            "help: remove `the`",
        ),
        (
            "while m mode the sw shall satisfy q",
            "F101 `while` needs an expression, not a mode\n"
            "  --> r.fret:1:9\n"
            "   | while m mode the sw shall satisfy q\n"
            "   |         ^^^^\n"
            "help: remove `mode`",
        ),
        (
            "the sw shall satisfy eventually q",
            "F101 the timing must stand before `satisfy`\n"
            "  --> r.fret:1:22\n"
            "   | the sw shall satisfy eventually q\n"
            "   |                      ^^^^^^^^^^\n"
            "help: write `eventually satisfy ...`",
        ),
        (
            "with probability > 0.9 the sw shall satisfy q",
            "F101 the probability must stand after `shall`\n"
            "  --> r.fret:1:1\n"
            "   | with probability > 0.9 the sw shall satisfy q\n"
            "   | ^^^^\n"
            "help: write it there: `shall with probability ... satisfy ...`",
        ),
        (
            "the sw shall probability > 0.9 satisfy q",
            "F101 `with` is missing before `probability`\n"
            "  --> r.fret:1:14\n"
            "   | the sw shall probability > 0.9 satisfy q\n"
            "   |              ^^^^^^^^^^^\n"
            "help: write `with probability ...`",
        ),
        (
            "the sw shall satisfy p && q",
            "F101 `&&` is not an operator of FRETish\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy p && q\n"
            "   |                        ^^\n"
            "help: write `&`",
        ),
        (
            "the sw shall satisfy p || q",
            "F101 `||` is not an operator of FRETish\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy p || q\n"
            "   |                        ^^\n"
            "help: write `|`",
        ),
        (
            "the sw shall satisfy x == 3",
            "F101 `==` is not an operator of FRETish\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy x == 3\n"
            "   |                        ^^\n"
            "help: write `=`",
        ),
        (
            "the sw shall satisfy not p",
            "F101 `not` is not an operator of FRETish\n"
            "  --> r.fret:1:22\n"
            "   | the sw shall satisfy not p\n"
            "   |                      ^^^\n"
            "help: write `!`",
        ),
        (
            "the sw shall satisfy TRUE",
            "F101 `TRUE` is not an operator of FRETish\n"
            "  --> r.fret:1:22\n"
            "   | the sw shall satisfy TRUE\n"
            "   |                      ^^^^\n"
            "help: write `true`",
        ),
        (
            "the sw shall satisfy 3 < x < 5",
            "F101 comparisons cannot be chained\n"
            "  --> r.fret:1:28\n"
            "   | the sw shall satisfy 3 < x < 5\n"
            "   |                            ^\n"
            "help: write two comparisons, and join them by `&`: `... < x & x < ...`",
        ),
        (
            "the sw shall satisfy x > .5",
            "F101 a number must begin with a digit\n"
            "  --> r.fret:1:26\n"
            "   | the sw shall satisfy x > .5\n"
            "   |                          ^\n"
            "help: write a 0 before the point",
        ),
        (
            "the sw shall satisfy x > 007",
            "F101 a number must not begin with 0\n"
            "  --> r.fret:1:26\n"
            "   | the sw shall satisfy x > 007\n"
            "   |                          ^^\n"
            "help: remove the leading zeros",
        ),
        (
            "the sw shall alwyas satisfy q",
            "F107 FRETish does not allow the word `alwyas` here\n"
            "  --> r.fret:1:14\n"
            "   | the sw shall alwyas satisfy q\n"
            "   |              ^^^^^^\n"
            "help: did you mean `always`?",
        ),
        (
            "durring m the sw shall satisfy q",
            "F107 FRETish does not allow the word `durring` here\n"
            "  --> r.fret:1:1\n"
            "   | durring m the sw shall satisfy q\n"
            "   | ^^^^^^^\n"
            "help: did you mean `during`?",
        ),
        (
            "the sw shall eventually stopped & p.",
            "F104 missing `satisfy` before `stopped & p`\n"
            "  --> r.fret:1:25\n"
            "   | the sw shall eventually stopped & p.\n"
            "   |                         ^^^^^^^^^^^\n"
            "help: write `satisfy stopped & p`",
        ),
        (
            "the sw shall satisfy first",
            "F109 `first` is a key word of FRETish and cannot be a name\n"
            "  --> r.fret:1:22\n"
            "   | the sw shall satisfy first\n"
            "   |                      ^^^^^\n"
            'help: choose another name, or quote it: `"first"`',
        ),
        (
            "the sw shall satisfy (p",
            "F101 1 `(` is not closed\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy (p\n"
            "   |                        ^\n"
            "help: write `)` here, or where the part in parentheses must end",
        ),
        (
            "the sw shall satisfy p the sw shall satisfy q",
            "F117 a second sentence begins here\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy p the sw shall satisfy q\n"
            "   |                        ^^^\n"
            "help: give each sentence a header with an `id` between two lines "
            "`+++`, or its own file",
        ),
        (
            "when p is on the sw shall satisfy q",
            "F101 `on` does not fit here\n"
            "  --> r.fret:1:11\n"
            "   | when p is on the sw shall satisfy q\n"
            "   |           ^^\n"
            "help: expected `true` or `false`",
        ),
        (
            "except before m the sw shall satisfy q",
            "F101 `before` does not fit here\n"
            "  --> r.fret:1:8\n"
            "   | except before m the sw shall satisfy q\n"
            "   |        ^^^^^^\n"
            "help: expected a scope (`in m`, `before m`, ...)",
        ),
        (
            "stopped",
            "F101 the sentence ends too early\n"
            "  --> r.fret:1:8\n"
            "   | stopped\n"
            "   |        ^\n"
            "help: expected `shall`",
        ),
        (
            "the sw shall with probability > 1 satisfy q",
            "F110 no run can have the probability `with probability > 1`\n"
            "  --> r.fret:1:14\n"
            "   | the sw shall with probability > 1 satisfy q\n"
            "   |              ^^^^^^^^^^^^^^^^^^^^\n"
            "help: a probability lies between 0 and 1; `> 1` and `< 0` can never hold",
        ),
        (
            "the sw shall satisfy the p",
            "F101 an expression cannot contain `the`\n"
            "  --> r.fret:1:22\n"
            "   | the sw shall satisfy the p\n"
            "   |                      ^^^\n"
            "help: remove `the`",
        ),
        # Words of other languages, after a whole expression too.
        (
            "the sw shall satisfy p and q",
            "F101 `and` is not an operator of FRETish\n"
            "  --> r.fret:1:24\n"
            "   | the sw shall satisfy p and q\n"
            "   |                        ^^^\n"
            "help: write `&`",
        ),
        (
            "the sw shall until (p or q) satisfy r",
            "F101 `or` is not an operator of FRETish\n"
            "  --> r.fret:1:23\n"
            "   | the sw shall until (p or q) satisfy r\n"
            "   |                       ^^\n"
            "help: write `|`",
        ),
    ],
)
def test_a_mistake_is_told_with_its_place_and_its_fix(text: str, message: str) -> None:
    assert render(mistake_of(text)) == message


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("", "F106", ""),
        (" \n ", "F106", ""),
        ("shall always satisfy q", "F111", "shall"),
        ("upon p shall satisfy q", "F111", "shall"),
        ("the shall satisfy q", "F111", "shall"),
        ("the sw shall within 2.5 ticks satisfy p", "F108", "2.5 ticks"),
        ("the sw shall within -3 ticks satisfy p", "F108", "-3 ticks"),
        ("the sw shall within 2e1 ticks satisfy p", "F108", "2e1 ticks"),
        ("the sw shall with probability > 1.5 satisfy q", "F110", "with probability > 1.5"),
        ("the sw shall with probability < 0 satisfy q", "F110", "with probability < 0"),
        ("the sw shall satisfy What", "F109", "What"),
    ],
)
def test_a_mistake_has_its_code_and_its_place(text: str, code: str, place: str) -> None:
    found = mistake_of(text)
    assert found.span is not None
    assert (found.code.number, found.span.text) == (code, place)
    assert found.help


@pytest.mark.parametrize(
    ("response", "character", "fix"),
    [
        ("a[3]", "[", 'quote a name with brackets: `"a[3]"`'),
        ("_p", "_", "a name begins with a letter"),
        ('"p', '"', "close the quotes, or remove them"),
        ("\u201cp\u201d", "\u201c", 'write `"p"`'),
        ("\u201cp", "\u201c", 'use straight quotes: `"`'),
        ("p\u201d", "\u201d", 'use straight quotes: `"`'),
        ("'p'", "'", 'write `"p"`'),
        ("'p", "'", 'use double quotes: `"`'),
        ("x \u2264 3", "\u2264", "write `<=`"),
        ("x \u2265 3", "\u2265", "write `>=`"),
        ("x \u2260 3", "\u2260", "write `!=`"),
        ("p \u2192 q", "\u2192", "write `->`"),
        ("p \u2227 q", "\u2227", "write `&`"),
        ("p \u2228 q", "\u2228", "write `|`"),
        ("\u00acp", "\u00ac", "write `!`"),
        ("p ? q", "?", "names are letters, digits, `_`, `.` and `%`"),
        ("p\u00e9", "\u00e9", "names are letters, digits, `_`, `.` and `%`"),
    ],
)
def test_a_character_that_no_word_has_is_told(response: str, character: str, fix: str) -> None:
    found = mistake_of(f"the sw shall satisfy {response}")
    assert found.code.number == "F101"
    assert found.message == f"FRETish does not use the character `{character}`"
    assert found.span is not None
    assert (found.span.text, found.span.start) == (character, 21 + response.index(character))
    assert found.help == fix


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ("MS", "write `milliseconds`"), ("msec", "write `milliseconds`"),
        ("Us", "write `microseconds`"), ("S", "write `seconds`"), ("Min", "write `minutes`"),
        ("mins", "write `minutes`"), ("H", "write `hours`"), ("hr", "write `hours`"),
        ("steps", "did you mean `ticks`?"), ("cycles", "did you mean `ticks`?"),
        ("timepoints", "did you mean `ticks`?"),
        ("milisecond", "did you mean `milliseconds`?"), ("Hors", "did you mean `hours`?"),
    ],
)  # fmt: skip
def test_a_unit_of_other_tools_has_its_word_here(written: str, words: str) -> None:
    assert mistake_of(f"the sw shall within 3 {written} satisfy q").help == words


@pytest.mark.parametrize(
    ("text", "fixed"),
    [
        ("the sw shall within 3 MS satisfy p", "the sw shall within 3 milliseconds satisfy p"),
        ("in m & n the sw shall satisfy q", "while m & n the sw shall satisfy q"),
        ("the sw must satisfy q", "the sw shall satisfy q"),
        ("when p then the sw shall satisfy q", "when p the sw shall satisfy q"),
        ("in the m mode the sw shall satisfy q", "in m mode the sw shall satisfy q"),
        ("while m mode the sw shall satisfy q", "while m the sw shall satisfy q"),
        ("the sw shall satisfy not p", "the sw shall satisfy ! p"),
        ("the sw shall satisfy TRUE", "the sw shall satisfy true"),
        ("the sw shall satisfy 3 < x < 5", "the sw shall satisfy 3 < x & x < 5"),
        ("the sw shall eventually stopped", "the sw shall eventually satisfy stopped"),
        ("the sw shall satisfy first", 'the sw shall satisfy "first"'),
        ("when p is on the sw shall satisfy q", "when p is true the sw shall satisfy q"),
        ("the sw shall satisfy a[3]", 'the sw shall satisfy "a[3]"'),
    ],
)
def test_what_the_fix_says_is_fretish(text: str, fixed: str) -> None:
    assert mistake_of(text).is_error
    assert isinstance(parse(Source("r.fret", fixed).span()), Sentence)


@pytest.mark.parametrize("timing", ["within 3 seconds", "for 3 ticks"])
def test_a_counting_timing_at_the_wrong_place_keeps_its_duration_in_the_fix(timing: str) -> None:
    """`within satisfy ...` would be no FRETish."""
    found = mistake_of(f"the sw shall satisfy {timing} q")
    assert found.message == "the timing must stand before `satisfy`"
    assert f"{timing.split()[0]} satisfy" not in (found.help or "")


def test_the_fix_of_a_negative_duration_is_not_a_smaller_unit() -> None:
    assert "smaller" not in (mistake_of("the sw shall within -3 ticks satisfy q").help or "")


def test_only_the_first_mistake_is_told() -> None:
    assert render(mistake_of("the sw must alwyas satisfy not q")).startswith(
        "F107 a requirement uses"
    )


def test_a_mistake_of_a_later_line_is_shown_with_its_line() -> None:
    assert render(mistake_of("whenever p\n  the sw shall\n  alwyas satisfy q")) == (
        "F107 FRETish does not allow the word `alwyas` here\n"
        "  --> r.fret:3:3\n"
        "   |   alwyas satisfy q\n"
        "   |   ^^^^^^\n"
        "help: did you mean `always`?"
    )
