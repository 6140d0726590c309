"""Operators of other languages; a fix is safe only where it cannot change what is meant."""

import pytest

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse


def mistake_of(response: str) -> Diagnostic:
    found = parse(Source("r.fret", f"the sw shall satisfy {response}").span())
    assert isinstance(found, Diagnostic), response
    return found


@pytest.mark.parametrize(
    ("response", "written", "fix"),
    [
        ("p and q", "and", "&"),
        ("p OR q", "OR", "|"),
        ("p implies q", "implies", "->"),
        ("p iff q", "iff", "<->"),
        ("p && q", "&&", "&"),
        ("p || q", "||", "|"),
        ("x == 3", "==", "="),
        ("x =< 3", "=<", "<="),
        ("x <> 3", "<>", "!="),
        ("not p", "not", "!"),
        ("not (p & q)", "not", "!"),
        ("x \u2265 3", "\u2265", ">="),
        ("\u201ca b\u201d", "\u201ca b\u201d", '"a b"'),
        ("p;", ";", ""),
        ("x > .5", "", "0"),
    ],
)
def test_what_has_one_meaning_is_fixed_for_sure(response: str, written: str, fix: str) -> None:
    found = mistake_of(response).fix
    assert found is not None
    assert (found.span.text, found.text, found.is_safe) == (written, fix, True)


@pytest.mark.parametrize(
    "response",
    [
        "p and q or r",
        "p or q and r",
        "p | q and r",
        "p | q && r",
        "p -> q or r",
        "p xor q || r",
        "p implies q or r",
        "not p and q",
        "not p & q",
        "not p -> q",
        "3 < x < 5",
        "p nand q",
        "p nor q",
        "p, q",
        "(p",
        "p)",
        '\u201cp & "q"',
        "'p' & 'q",
        "x => 3",
        "eventually p & q",
        "p until q",
        "speed is below 3",
    ],
)
def test_what_could_mean_two_things_is_never_sure(response: str) -> None:
    found = parse(Source("r.fret", f"the sw shall satisfy {response}").span())
    assert isinstance(found, Diagnostic)
    quoted = response.startswith("'p'")  # the pair is sure; the lonely one behind it is not
    assert found.help
    assert found.fix is None or found.fix.is_safe is quoted


@pytest.mark.parametrize(
    "response",
    [
        "(p | q) and r",
        "p & q or r",
        "p || q && r",
        "p implies q & r",
        "(p and q) | r",
        "p | (q && r)",
        '"a | b" and r',
    ],
)
def test_what_binds_in_one_way_only_is_sure(response: str) -> None:
    found = mistake_of(response).fix
    assert found is not None
    assert found.is_safe


def test_another_part_of_the_sentence_has_no_say_in_what_binds() -> None:
    found = parse(Source("r.fret", "when p | q the sw shall satisfy r and s").span())
    assert isinstance(found, Diagnostic)
    assert found.fix is not None
    assert found.fix.is_safe


@pytest.mark.parametrize(
    ("condition", "fix"),
    [("p and q", "&"), ("p or q", "|"), ("p implies q", "->"), ("p and x > 3 & q", "&")],
)
def test_a_word_that_joins_expressions_of_a_condition(condition: str, fix: str) -> None:
    found = parse(Source("r.fret", f"whenever {condition} the sw shall satisfy r").span())
    assert isinstance(found, Diagnostic)
    assert found.fix is not None
    assert (found.fix.text, found.fix.is_safe) == (fix, True)


def test_an_implication_of_a_number_is_asked_whether_it_is_a_comparison() -> None:
    found = mistake_of("x => 3")
    assert found.fix is not None
    assert (found.fix.span.text, found.fix.text) == ("=>", ">=")
    assert found.help == "`=>` is an implication: did you mean `>=`?"
