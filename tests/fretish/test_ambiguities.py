"""Warnings where FRETish means something else than many readers take it to mean."""

import pytest

from fretish.ambiguities import ambiguity_warnings
from fretish.diagnostics.diagnostic import Severity
from fretish.diagnostics.rendering import render_all
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import Sentence
from tests.each import each
from tests.meaning import COUNTING, TIMINGS


def codes(text: str) -> list[str]:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, Sentence), sentence
    found = list(ambiguity_warnings(sentence))
    assert {diagnostic.severity for diagnostic in found} <= {Severity.WARNING}
    return [diagnostic.code.number for diagnostic in found]


def warnings_of(text: str) -> str:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, Sentence), sentence
    return render_all(list(ambiguity_warnings(sentence)))


# Whole texts ----------------------------------------------------------------------------------


def test_a_condition_that_triggers_where_it_becomes_true() -> None:
    assert warnings_of("when too_close & moving the sw shall immediately satisfy stopped") == (
        "F204 warning: "
        "`when` triggers only at the ticks at which `too_close & moving` becomes true\n"
        "  --> r.fret:1:1\n"
        "   | when too_close & moving the sw shall immediately satisfy stopped\n"
        "   | ^^^^^^^^^^^^^^^^^^^^^^^\n"
        "help: write `whenever too_close & moving` to trigger at every tick at which it is "
        "true, or `upon too_close & moving` to keep this meaning"
    )


def test_a_sentence_without_a_timing() -> None:
    assert warnings_of("the sw shall satisfy q") == (
        "F205 warning: without a timing the response may come at any later tick\n"
        "  --> r.fret:1:5\n"
        "   | the sw shall satisfy q\n"
        "   |     ^^\n"
        "help: write `eventually` if you mean this, or `immediately`, `always`, `within N seconds`"
    )


def test_a_deadline_in_a_scope_that_ends() -> None:
    assert warnings_of("in m mode whenever p the sw shall within 3 ticks satisfy q") == (
        "F206 warning: if `m` ends the scope before the deadline, nothing is required\n"
        "  --> r.fret:1:35\n"
        "   | in m mode whenever p the sw shall within 3 ticks satisfy q\n"
        "   |                                   ^^^^^^^^^^^^^^\n"
        "help: the response is required only if the whole duration fits into the scope"
    )


def test_a_scope_after_a_mode() -> None:
    assert warnings_of("after x > 3 the sw shall always satisfy q") == (
        "F207 warning: only the first stretch of `x > 3` counts; later ones change nothing\n"
        "  --> r.fret:1:1\n"
        "   | after x > 3 the sw shall always satisfy q\n"
        "   | ^^^^^^^^^^^\n"
        "help: to begin again each time, use a condition: `upon !(x > 3)`"
    )


def test_a_scope_before_a_mode() -> None:
    assert warnings_of("before m mode the sw shall always satisfy q") == (
        "F208 warning: if `m` is true at the first tick, nothing is required\n"
        "  --> r.fret:1:1\n"
        "   | before m mode the sw shall always satisfy q\n"
        "   | ^^^^^^^^^^^^^\n"
        "help: if `m` can be true there, state what must hold at the start in another requirement"
    )


# Where each applies, and where not -------------------------------------------------------------


@pytest.mark.parametrize(
    ("condition", "warned"),
    [
        ("when p", True),
        ("WHEN p", True),
        ("if p", True),
        ("where p", True),
        ("unless p", True),
        ("when p is FALSE", True),
        ("when p and upon q", True),
        ("unless p and whenever q", True),
        ("upon p", False),  # `upon` says what it does
        ("whenever p", False),
        ("whenever p and whenever q", False),
        ("", False),
    ],
)
def test_an_edge_is_told_for_the_words_that_do_not_say_it(condition: str, warned: bool) -> None:
    expected = ["F204"] if warned else []
    assert codes(f"{condition} the sw shall immediately satisfy q") == expected


@pytest.mark.parametrize("condition", ["whenever p and when q", "whenever p or if q"])
def test_an_edge_is_told_where_a_later_word_makes_a_whenever_a_trigger(condition: str) -> None:
    """One other word anywhere makes the whole list a trigger."""
    assert codes(f"{condition} the sw shall immediately satisfy q") == ["F204"]


WORDINGS = {
    "null": "",
    "next": "at the next timepoint",
    "within": "within 3 ticks",
    "for": "for 3 ticks",
    "after": "after 3 ticks",
    "until": "until s",
    "before": "before s",
}
SCOPES = {
    "null": ("", []),
    "in": ("in m", []),
    "while": ("while m & n", []),
    "notin": ("unless in m", []),
    "before": ("before m", ["F208"]),
    "after": ("after m", ["F207"]),
    "onlyIn": ("only in m", []),
    "onlyBefore": ("only before m", []),
    "onlyAfter": ("only after m", ["F207"]),
}


@each("timing", TIMINGS)
@each("scope", SCOPES)
def test_each_scope_and_timing_has_its_own_warnings(scope: str, timing: str) -> None:
    scope_words, of_scope = SCOPES[scope]
    ends = scope in ("in", "while", "notin", "before")
    expected = [
        *(["F205"] if timing == "null" else []),
        *(["F206"] if timing == "within" and ends else []),
        *of_scope,
    ]
    timing_words = WORDINGS.get(timing, timing)
    assert codes(f"{scope_words} whenever p the sw shall {timing_words} satisfy q") == expected


def test_every_timing_has_a_wording() -> None:
    assert set(COUNTING) <= set(WORDINGS) <= set(TIMINGS)


def test_eventually_is_no_surprise_where_it_is_written() -> None:
    assert codes("the sw shall eventually satisfy q") == []


def test_a_sentence_may_have_several_surprises() -> None:
    assert codes("before m if p the sw shall within 0 ticks satisfy q") == ["F204", "F206", "F208"]


def test_the_fix_of_an_edge_is_fretish() -> None:
    for condition in ("p & (q | r)", "p -> q", "x > 3"):
        text = warnings_of(f"when {condition} the sw shall always satisfy q")
        for word in ("whenever", "upon"):
            fix = f"{word} {condition}"
            assert f"`{fix}`" in text
            assert codes(f"{fix} the sw shall always satisfy q") == []
