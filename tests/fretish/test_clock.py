"""Durations in ticks of the declared clock: exactly, or an error."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fretish import syntax as s
from fretish.clock import (
    Clock,
    Rounding,
    assumed_ticks,
    counts_in_ticks,
    in_ticks,
    in_words,
    period_of,
)
from fretish.diagnostics.diagnostic import Diagnostic, Severity
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.parser import parse
from tests.effort import FULL
from tests.meaning import CONDITIONS, SCOPES
from tests.strategies import Template

MS = 10**6
EXACT = Clock(100 * MS)
CONSERVATIVE = Clock(100 * MS, rounding=Rounding.CONSERVATIVE)
BY_MESSAGE = Clock(None, "/scan")


def read(text: str) -> s.Sentence:
    result = parse(Source("r.fret", text).span())
    assert isinstance(result, s.Sentence)
    return result


def ticks(timing: str, clock: Clock | None) -> int | Diagnostic | None:
    return in_ticks(read(f"the sw shall {timing} satisfy q"), clock)


@pytest.mark.parametrize(
    ("timing", "count"),
    [
        ("within 200 milliseconds", 2),
        ("for 3 seconds", 30),
        ("after 1 second", 10),
        ("within 1 minute", 600),
        ("within 1 hour", 36_000),
        ("within 300000 microseconds", 3),
        ("within 3 ticks", 3),
        ("within 0 seconds", 0),
        ("for 0 ticks", 0),
        ("eventually", None),
        ("until s", None),
    ],
)
def test_a_duration_is_converted_exactly(timing: str, count: int | None) -> None:
    assert ticks(timing, EXACT) == count
    assert ticks(timing, CONSERVATIVE) == count


def test_a_whole_number_of_ticks_is_not_rounded_whatever_the_sentence() -> None:
    for sentence in (
        "only in m the sw shall within 200 milliseconds satisfy q",
        "only after m the sw shall after 200 milliseconds satisfy q",
        "whenever p the sw shall with probability = 0.5 for 200 milliseconds satisfy q",
    ):
        assert in_ticks(read(sentence), CONSERVATIVE) == 2


def test_a_tick_is_exact_where_a_floating_point_number_is_not() -> None:
    assert ticks("within 1 second", Clock(333_333_333 * 3 + 1)) == 1
    assert ticks("within 3 seconds", Clock(10**9 // 10)) == 30
    assert isinstance(ticks("within 1 second", Clock(333_333_333)), Diagnostic)
    assert ticks("within 1000000000 hours", Clock(1)) == 3_600 * 10**18


@pytest.mark.parametrize("clock", [EXACT, CONSERVATIVE])
def test_a_duration_in_a_predicate_counts_ticks(clock: Clock) -> None:
    for timed, counted in {
        "persisted(500 ms, p)": "persisted(5, p)",
        "occurred(0.1 s, 1 min, p) & x > 3 s": "occurred(1, 600, p) & x > 3 s",
        "persists(2, occurs(200 ms, p))": "persists(2, occurs(2, p))",
        "persisted(0 h, p)": "persisted(0, p)",
        "persisted(500 milliseconds, p)": "persisted(5, p)",
        "occurred(0.1 sec, 1 Minute, p) & q": "occurred(1, 600, p) & q",
    }.items():
        for sentence in (
            "whenever {} the sw shall immediately satisfy q",
            "while {} the sw shall always satisfy q",
            "the sw shall until {} satisfy q",
            "the sw shall always satisfy q | !({})",
        ):
            result = counts_in_ticks(read(sentence.format(timed)), clock)
            assert result == read(sentence.format(counted))


@pytest.mark.parametrize(
    ("call", "clock", "message"),
    [
        ("persisted(250 ms, p)", EXACT, "250 ms is 2.5 ticks of 100 ms"),
        ("occurred(1, 250 ms, p)", CONSERVATIVE, "250 ms is 2.5 ticks of 100 ms"),
        ("persists(2 m, p)", EXACT, "a duration needs a unit, and `m` is not one"),
        ("occurs(2 s, p)", None, "`2 s` is no number of ticks: there is no tick"),
        (
            "occurs(2 s, p)",
            BY_MESSAGE,
            "the clock ticks with each message of /scan: it cannot count seconds",
        ),
    ],
)
def test_what_is_no_number_of_ticks_in_a_predicate_is_an_error(
    call: str, clock: Clock | None, message: str
) -> None:
    sentence = read(f"the sw shall always satisfy q & !{call}")
    result = counts_in_ticks(sentence, clock)
    assert isinstance(result, Diagnostic)
    assert result.message == message
    assert result.span is not None
    assert result.span.text in call


def test_a_duration_between_two_ticks_is_an_error() -> None:
    wrong = ticks("within 250 milliseconds", EXACT)
    assert isinstance(wrong, Diagnostic)
    assert render(wrong) == (
        "F307 250 milliseconds is 2.5 ticks of 100 ms\n"
        "  --> r.fret:1:21\n"
        "   | the sw shall within 250 milliseconds satisfy q\n"
        "   |                     ^^^^^^^^^^^^^^^^\n"
        "help: use a whole number of ticks (200 ms or 300 ms), a finer `tick`, or "
        '`rounding = "conservative"` under `[clock]`'
    )


@pytest.mark.parametrize(
    ("timing", "count"),
    [
        ("within 250 milliseconds", 2),
        ("within 299 milliseconds", 2),
        ("for 250 milliseconds", 3),
        ("for 201 milliseconds", 3),
        ("for 1 microsecond", 1),
    ],
)
def test_conservative_rounding_goes_to_the_stricter_side(timing: str, count: int) -> None:
    assert ticks(timing, CONSERVATIVE) == count


@pytest.mark.parametrize(
    ("scope", "chance", "within", "for_"),
    [
        ("", "", 2, 3),
        ("in m", "", 2, 3),
        ("except in m", "", 2, 3),
        ("before m", "", 2, 3),
        ("after m", "", 2, 3),
        ("only in m", "", 3, 2),
        ("only before m", "", 3, 2),
        ("only after m", "", 3, 2),
        ("", "with probability >= 0.9", 2, 3),
        ("", "with probability > 0.9", 2, 3),
        ("", "with probability <= 0.9", 3, 2),
        ("in m", "with probability < 0.9", 3, 2),
        ("only in m", "with probability > 0.9", 3, 2),
        ("only in m", "with probability < 0.9", 2, 3),
    ],
)
def test_the_stricter_side_is_the_other_one_where_the_demand_is_negated(
    scope: str, chance: str, within: int, for_: int
) -> None:
    def rounded(timing: str) -> int | Diagnostic | None:
        text = f"{scope} the sw shall {chance} {timing} 250 milliseconds satisfy q"
        return in_ticks(read(text.strip()), CONSERVATIVE)

    assert (rounded("within"), rounded("for")) == (within, for_)


def test_what_has_no_stricter_side_is_refused() -> None:
    wrong = ticks("after 250 milliseconds", CONSERVATIVE)
    assert isinstance(wrong, Diagnostic)
    assert render(wrong) == (
        "F307 250 milliseconds is 2.5 ticks of 100 ms, and `after` has no stricter side to round "
        "to\n"
        "  --> r.fret:1:20\n"
        "   | the sw shall after 250 milliseconds satisfy q\n"
        "   |                    ^^^^^^^^^^^^^^^^\n"
        "help: use a whole number of ticks (200 ms or 300 ms), or a finer `tick`"
    )
    wrong = ticks("with probability = 0.5 within 250 milliseconds", CONSERVATIVE)
    assert isinstance(wrong, Diagnostic)
    assert wrong.message == (
        "250 milliseconds is 2.5 ticks of 100 ms, and `=` has no stricter side to round to"
    )


def test_nothing_is_rounded_to_0() -> None:
    wrong = ticks("within 99 milliseconds", CONSERVATIVE)
    assert isinstance(wrong, Diagnostic)
    assert wrong.is_error
    assert wrong.message == "99 milliseconds is 0.99 ticks of 100 ms"


def test_the_fix_does_not_propose_the_rounding_that_is_declared_already() -> None:
    wrong = ticks("within 99 milliseconds", CONSERVATIVE)
    assert isinstance(wrong, Diagnostic)
    assert wrong.help is not None
    assert "conservative" not in wrong.help


def test_a_number_of_ticks_that_is_not_whole_is_never_shown_as_whole() -> None:
    wrong = ticks("for 1000000001 microseconds", Clock(10**6))
    assert isinstance(wrong, Diagnostic)
    assert wrong.message != "1000000001 microseconds is 1e+06 ticks of 1 ms"


@given(
    st.sampled_from(["within", "for"]),
    st.integers(0, 10**7),
    st.integers(1, 10**10),
)
def test_rounding_is_by_less_than_a_tick(word: str, amount: int, period: int) -> None:
    found = ticks(f"{word} {amount} microseconds", Clock(period, rounding=Rounding.CONSERVATIVE))
    whole, over = divmod(amount * 1000, period)
    if over == 0:
        assert found == whole
    elif word != "within":
        assert found == whole + 1
    elif whole:
        assert found == whole
    else:
        assert isinstance(found, Diagnostic)


def test_a_message_clock_counts_ticks_only() -> None:
    assert ticks("within 3 ticks", BY_MESSAGE) == 3
    wrong = ticks("within 3 seconds", BY_MESSAGE)
    assert isinstance(wrong, Diagnostic)
    assert render(wrong) == (
        "F313 the clock ticks with each message of /scan: it cannot count seconds\n"
        "  --> r.fret:1:21\n"
        "   | the sw shall within 3 seconds satisfy q\n"
        "   |                     ^^^^^^^^^\n"
        'help: count ticks, or declare a period: `tick = "100 ms"`'
    )


def test_without_a_clock_a_unit_counts_ticks_and_that_is_said() -> None:
    assert ticks("within 3 hours", None) == 3
    diagnostic = assumed_ticks(read("the sw shall within 3 hours satisfy q"), None)
    assert diagnostic is not None
    assert diagnostic.severity is Severity.WARNING
    assert render(diagnostic) == (
        "F312 warning: no clock says what a tick is: `3 hours` is read as 3 ticks, as FRET does\n"
        "  --> r.fret:1:21\n"
        "   | the sw shall within 3 hours satisfy q\n"
        "   |                     ^^^^^^^\n"
        'help: declare `[clock]` with `tick = "100 ms"` in bindings.toml, or write ticks'
    )


def test_nothing_is_said_where_ticks_are_counted() -> None:
    assert assumed_ticks(read("the sw shall within 3 ticks satisfy q"), None) is None
    assert assumed_ticks(read("the sw shall always satisfy q"), None) is None
    assert assumed_ticks(read("the sw shall within 3 hours satisfy q"), EXACT) is None


@pytest.mark.parametrize(
    ("nanoseconds", "text"),
    [
        (100 * MS, "100 ms"),
        (2 * 10**9, "2 s"),
        (1_500_000, "1.5 ms"),
        (1, "1 ns"),
        (2_500, "2.5 us"),
    ],
)
def test_a_period_is_shown_in_a_unit_that_people_read(nanoseconds: int, text: str) -> None:
    assert in_words(nanoseconds) == text


def test_two_different_periods_are_not_shown_alike() -> None:
    assert in_words(33_333_333) != in_words(33_333_334)


# The law: a rounded sentence asks for at least as much as the one that is not rounded -----------


@pytest.mark.slow
@given(
    st.sampled_from(SCOPES),
    st.sampled_from(CONDITIONS),
    st.sampled_from(["within", "for"]),
    st.integers(2, 5),
    st.integers(1, 30),
    st.lists(st.tuples(st.booleans(), st.booleans(), st.booleans()), min_size=1, max_size=9),
)
@settings(max_examples=2000 if FULL else 150)
def test_whatever_satisfies_the_rounded_sentence_satisfies_the_exact_one(
    scope: str, condition: str, timing: str, parts: int, amount: int, rows: list[tuple[bool, ...]]
) -> None:
    """The exact sentence is read on a clock of 1 ms, on which each tick is `parts` ticks."""
    exact = Template(scope, condition, timing, amount)
    sentence = read(exact.sentence.replace(" ticks ", " milliseconds ").strip())
    rounded = in_ticks(sentence, Clock(parts * MS, rounding=Rounding.CONSERVATIVE))
    if isinstance(rounded, Diagnostic):
        return
    assert rounded is not None

    def holds(template: Template, each: int) -> bool:
        return template.satisfied(
            {name: [row[i] for row in rows for _ in range(each)] for i, name in enumerate("mpq")}
        )

    if holds(replace(exact, n=rounded), 1):
        assert holds(exact, parts)


@given(st.integers(1, 10**12), st.integers(0, 10**9))
def test_the_period_of_a_clock_is_read_back_from_its_text(period: int, phase: int) -> None:
    assert period_of(str(Clock(period, phase=phase % period))) == period
    assert period_of(f"{Clock(period)}, by log_time") == period


def test_a_clock_that_ticks_by_message_has_no_period() -> None:
    for text in ("each message of /5 s", "each message of /scan, by header.stamp", "", "... s"):
        assert period_of(text) is None
