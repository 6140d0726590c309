"""Parts at a wrong place, missing, or there twice: what is said, and what the fix makes of it."""

import pytest

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import apply_fixes
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import Sentence


def mistake_of(text: str) -> Diagnostic:
    found = parse(Source("r.fret", text).span())
    assert isinstance(found, Diagnostic), text
    return found


@pytest.mark.parametrize(
    ("text", "message", "fixed"),
    [
        ("satisfy p until q", "the timing must stand before `satisfy`", "until q satisfy p"),
        ("satisfy p before q.", "the timing must stand before `satisfy`", "before q satisfy p."),
        (
            "satisfy p & q within 5 seconds",
            "the timing must stand before `satisfy`",
            "within 5 seconds satisfy p & q",
        ),
        ("satisfy p eventually", "the timing must stand before `satisfy`", "eventually satisfy p"),
        ("satisfy eventually p", "the timing must stand before `satisfy`", "eventually satisfy p"),
        (
            "satisfy within 3 ticks p",
            "the timing must stand before `satisfy`",
            "within 3 ticks satisfy p",
        ),
        ("never not satisfy p", "`not` cannot stand before `satisfy`", "always satisfy p"),
        ("always not satisfy p", "`not` cannot stand before `satisfy`", "never satisfy p"),
        ("satisfy satisfy p", "`satisfy` is written twice", "satisfy p"),
        ("satisfy the p", "an expression cannot contain `the`", "satisfy p"),
        ("satisfy (p))", "there is no `(` for this `)`", "satisfy (p)"),
        ("satisfy ((p", "2 `(` are not closed", "satisfy ((p))"),
    ],
)
def test_a_fix_puts_the_part_where_it_belongs(text: str, message: str, fixed: str) -> None:
    found = mistake_of(f"the sw shall {text}")
    assert found.message == message
    assert found.fix is not None
    assert found.span is not None
    whole = found.span.source.span()
    assert apply_fixes(whole, [found.fix]) == f"the sw shall {fixed}"
    assert isinstance(parse(Source("r.fret", f"the sw shall {fixed}").span()), Sentence)


@pytest.mark.parametrize(
    ("text", "at", "message", "words"),
    [
        ("the sw shall satisfy p unless q", "unless", "the condition must stand before", "p | q"),
        (
            "the sw shall satisfy p when q",
            "when",
            "the condition must stand before",
            "`when q the C",
        ),
        (
            "the sw shall satisfy p while q",
            "while",
            "the scope must stand before",
            "`while q the C",
        ),
        ("the sw shall always satisfy p until q", "until", "the timing must stand", "one timing"),
        ("the sw shall for 2 ticks within 3 ticks satisfy q", "within", "a second one", "each"),
        ("the sw shall eventually always satisfy q", "always", "a second one", "each"),
        ("the sw shall not satisfy q", "not", "`not` cannot stand", "`shall never satisfy p`"),
        ("the sw shall eventually not satisfy q", "not", "`not` cannot", "`satisfy !(p)`"),
        ("the sw shall satisfy shall", "shall", "the response is missing", "`satisfy p`"),
        ("the sw shall satisfy", "", "the response is missing after `satisfy`", "`satisfy p`"),
        ("the sw shall until satisfy q", "satisfy", "the stop condition is", "`until p`"),
        ("before the sw shall satisfy q", "the", "the mode is missing", "`before p`"),
        ("whenever the sw shall satisfy q", "the", "the condition is missing", "`whenever p`"),
        ("in the sw shall satisfy q", "the", "the mode is missing after `in`", "`in p`"),
        (
            "When the battery is low the sw shall satisfy q",
            "the",
            "cannot contain `the`",
            "`battery_low`",
        ),
        (
            "if the door of a sw is open, sw shall satisfy q",
            "the",
            "cannot contain `the`",
            "`door_sw_open`",
        ),
        ("the big sw shall satisfy q", "big sw", "a component must be one name", "`big_sw`"),
        ("the sw satisfy q", "satisfy", "`shall` is missing", "`shall satisfy`"),
        ("sw may satisfy q", "may", "a requirement uses `shall`", "did you mean `shall`?"),
    ],
)
def test_what_has_no_safe_fix_is_told_in_its_own_words(
    text: str, at: str, message: str, words: str
) -> None:
    found = mistake_of(text)
    assert found.span is not None
    assert found.span.text == at
    assert message in found.message
    assert words in (found.help or "")


@pytest.mark.parametrize(
    ("between", "second"),
    [
        (" ", "the sw shall satisfy q"),
        (". ", "the sw shall satisfy q"),
        (".\n", "when r the sw shall satisfy q"),
        ("\n", "sw shall satisfy q"),
        ("\n\n", "before m, the sw shall satisfy q"),
        (". ", "in m mode the sw must satisfy q"),
    ],
)
def test_a_second_sentence_is_told_where_it_begins(between: str, second: str) -> None:
    found = mistake_of(f"the sw shall always satisfy p{between}{second}")
    assert found.code.number == "F117"
    assert found.span is not None
    assert found.span.source.text[found.span.start :] == second


def test_a_timing_behind_the_response_is_no_second_sentence() -> None:
    assert mistake_of("the sw shall satisfy p before shall").code.number == "F101"
