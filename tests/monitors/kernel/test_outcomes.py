"""An outcome is what its fields mean, and certain where no value of the unknown would change it."""

import functools
import random
import tracemalloc
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from itertools import product
from typing import ClassVar
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.kernel import (
    INCONCLUSIVE,
    NO_DATA,
    SATISFIED,
    VACUOUS,
    VIOLATED,
    Column,
    Monitor,
    Outcome,
    evaluate,
)
from monitors.kernel import outcomes as kernel_outcomes
from monitors.kernel.columns import LARGE, column, columns_of, pieces_of
from monitors.kernel.outcomes import stepped
from monitors.kernel.verdicts import Requirement, Signals, Truth, Verdict
from tests.each import each
from tests.effort import FULL
from tests.monitoring import monitor, packed
from tests.strategies import Template, few_templates

EXACT = {
    "whenever p the sw shall within 2 ticks satisfy q": 20,
    "whenever p the sw shall eventually satisfy q": 20,
    "whenever p the sw shall for 2 ticks satisfy q": 0,
    "whenever p the sw shall at the next timepoint satisfy q": 0,
}
"""Sentences whose approximations are exact: each proposition comes once in what a demand needs.

With the least number of uncertain triggers that the test must meet to be worth anything: 0 where a
demand waits for no answer, so that nothing can be uncertain.
"""

Trace = Mapping[str, Sequence[Truth]]


def outcomes(machine: Monitor, trace: Trace) -> tuple[Outcome, Outcome]:
    """The outcome of the one requirement, by each of the two engines."""
    names = tuple(machine.PROPOSITIONS)
    rows = zip(*(trace[name] for name in names), strict=True)
    ticks, columns = columns_of(pieces_of(rows), len(names))
    by_name = dict(zip(names, columns, strict=True))
    (whole,), (online,) = evaluate(machine, by_name, ticks), stepped(machine, by_name, ticks)
    return whole, online


def completions(trace: Trace) -> Iterator[dict[str, list[Truth]]]:
    """The trace with each unknown value put to false and to true."""
    places = [(name, i) for name, row in trace.items() for i, v in enumerate(row) if v is None]
    for values in product((False, True), repeat=len(places)):
        full = {name: list(row) for name, row in trace.items()}
        for (name, i), value in zip(places, values, strict=True):
            full[name][i] = value
        yield full


def demands_of(outcome: Outcome) -> set[tuple[int, object]]:
    """Each trigger with its answer, or with the deadline of its open demand."""
    return {*outcome.answers, *((trigger, (deadline,)) for trigger, deadline in outcome.open)}


def drawn(choose: random.Random, names: Sequence[str], ticks: int, most: int) -> Trace:
    """Known but for at most so many values."""
    trace: dict[str, list[Truth]] = {
        name: [choose.random() < choose.choice((0.3, 0.6)) for _ in range(ticks)] for name in names
    }
    for _ in range(choose.randint(1, most)):
        trace[choose.choice(names)][choose.randrange(ticks)] = None
    return trace


def certainties(machine: Monitor, trace: Trace) -> tuple[set[int], set[int]]:
    """The triggers that the outcome calls certain, and those that are the same in all completions.

    The engines must agree, no certain demand may be missing, and only a demand can be uncertain.
    """
    outcome, online = outcomes(machine, trace)
    assert outcome == online, "the engines differ"
    listed = demands_of(outcome)
    everywhere = set.intersection(
        *(demands_of(outcomes(machine, t)[0]) for t in completions(trace))
    )
    missing = {pair for pair in everywhere if pair[0] in outcome.triggers} - listed
    assert not missing, "a demand that is the same in all completions is not listed"
    assert {*outcome.uncertain} <= {trigger for trigger, _ in listed}, (
        "an uncertain trigger has no demand"
    )
    certain = {trigger for trigger, _ in listed} - {*outcome.uncertain}
    return certain, {trigger for trigger, _ in listed & everywhere}


@pytest.mark.slow
@each("template", few_templates())
def test_what_is_said_to_be_certain_is_so_for_all_values_of_the_unknown(
    template: Template,
) -> None:
    machine, choose = monitor(template.sentence), random.Random(repr(template))
    for _ in range(4):
        certain, right = certainties(machine, drawn(choose, tuple(machine.PROPOSITIONS), 6, 3))
        assert certain <= right, template


@pytest.mark.slow
@pytest.mark.parametrize("sentence", EXACT)
def test_what_is_certain_is_said_to_be(sentence: str) -> None:
    machine, choose = monitor(sentence), random.Random(sentence)
    certain_triggers = uncertain_triggers = 0
    for _ in range(120 if FULL else 60):
        trace = drawn(choose, ("p", "q"), 6, 4)
        certain, right = certainties(machine, trace)
        assert certain == right, trace
        certain_triggers += len(certain)
        uncertain_triggers += len(outcomes(machine, trace)[0].uncertain)
    assert certain_triggers > 20, "too few to show anything"
    assert uncertain_triggers >= EXACT[sentence], "too few to show anything"


def test_an_answer_behind_an_unknown_value_is_uncertain() -> None:
    machine = monitor("whenever p the sw shall within 3 ticks satisfy q")
    p = [True, False, False, False, True, False]
    q: list[Truth] = [False, None, True, False, False, None]
    outcome, online = outcomes(machine, {"p": p, "q": q})
    assert (outcome.answers, outcome.open) == (((0, 2),), ((4, 7),))
    assert outcome.uncertain == online.uncertain == (0, 4)
    assert outcome.as_json()["uncertain"] == [0, 4]
    known, _ = outcomes(machine, {"p": p, "q": [False, False, True, False, False, False]})
    assert (known.answers, known.open, known.uncertain) == (((0, 2),), ((4, 7),), ())


@given(st.randoms(use_true_random=False), st.integers(0, 30), st.integers(0, 30))
def test_the_engines_agree_over_several_batches(
    choose: random.Random, ticks: int, known: int
) -> None:
    """Also where the first unknown value is in a later one."""
    machine = several()
    trace = {
        name: [
            choose.choice((True, False) if i < known else (True, False, None)) for i in range(ticks)
        ]
        for name in machine.PROPOSITIONS
    }
    _, columns = packed(trace)
    with mock.patch.object(kernel_outcomes, "_TICKS", 8):
        online = stepped(machine, columns, ticks)
    assert online == evaluate(machine, columns, ticks)


@functools.cache
def several() -> Monitor:
    return monitor(
        "in m mode, upon p the sw shall within 9 ticks satisfy q",
        "whenever q the sw shall satisfy p",
    )


# The outcome of any signals -------------------------------------------------------------------


class Given(Monitor):
    """A monitor whose signals are its propositions."""

    PROPOSITIONS: ClassVar[Mapping[str, str]] = {name: name for name in Signals._fields}
    LITERALS = tuple((name, name, True) for name in Signals._fields)

    def reset(self) -> None:
        """There is nothing to forget."""

    @staticmethod
    def columns(every: int, **signals: int) -> tuple[Signals[int], ...]:
        return (Signals(**signals),)


def outcome_of(
    signals: Mapping[str, Column],
    ticks: int,
    deadline_ticks: int | None,
    end: Verdict = INCONCLUSIVE,
) -> Outcome:
    class WithHorizon(Given):
        REQUIREMENTS = (Requirement("R1", "", "", deadline_ticks),)

    (outcome,) = evaluate(WithHorizon(), signals, ticks, end)
    return outcome


def naive(
    certain: Signals[list[bool]],
    possible: Signals[list[bool]],
    deadline_ticks: int | None,
    end: Verdict,
) -> Outcome:
    """The outcome tick by tick, from what its fields mean."""
    ticks = len(certain.trigger)
    violated = [
        a or b for a, b in zip(certain.violation, certain.violation_inevitable, strict=True)
    ]
    perhaps = [
        a or b for a, b in zip(possible.violation, possible.violation_inevitable, strict=True)
    ]
    verdict = naive_verdict(certain, possible, violated, perhaps)
    finite = None
    if ticks and (any(certain.violation) or certain.violated_if_ended[-1]):
        finite = False
    elif ticks and not any(possible.violation) and not possible.violated_if_ended[-1]:
        finite = True
    unknown = [a != b for a, b in zip(violated, perhaps, strict=True)]
    if end == VIOLATED and verdict == "inconclusive":
        verdict, violated[-1] = VIOLATED, True
    triggers = tuple(tick for tick in range(ticks) if certain.trigger[tick])
    answers, still_open, uncertain = [], [], []
    for trigger in triggers:
        at = trigger
        while at < ticks and possible.obligation_pending[at] and not certain.answer[at]:
            at += 1
        late = (
            deadline_ticks is not None and (ticks if at == ticks else at) - trigger > deadline_ticks
        )
        if at == ticks and not late:
            still_open.append(
                (trigger, None if deadline_ticks is None else trigger + deadline_ticks)
            )
        elif at < ticks and certain.answer[at] and not late:
            answers.append((trigger, at))
        else:
            continue
        if any(not certain.obligation_pending[k] or possible.answer[k] for k in range(trigger, at)):
            uncertain.append(trigger)
    return Outcome(
        "R1",
        ticks,
        verdict,
        finite,
        next((tick for tick, value in enumerate(violated) if value), None),
        runs(violated),
        runs(unknown),
        triggers,
        tuple(answers),
        tuple(still_open),
        tuple(uncertain),
    )


def naive_verdict(
    certain: Signals[list[bool]],
    possible: Signals[list[bool]],
    violated: Sequence[bool],
    perhaps: Sequence[bool],
) -> Verdict:
    if not violated:
        return NO_DATA
    for sure, maybe, verdict in (
        (any(violated), any(perhaps), VIOLATED),
        (certain.obligation_pending[-1], possible.obligation_pending[-1], INCONCLUSIVE),
        (any(certain.trigger), any(possible.trigger), SATISFIED),
    ):
        if maybe:
            return verdict if sure else NO_DATA
    return VACUOUS


def runs(values: Sequence[bool]) -> tuple[tuple[int, int], ...]:
    found: list[tuple[int, int]] = []
    for tick, value in enumerate(values):
        if value and found and found[-1][1] == tick - 1:
            found[-1] = (found[-1][0], tick)
        elif value:
            found.append((tick, tick))
    return tuple(found)


def hold_to_the_definition(
    codes: Mapping[str, bytes], ticks: int, deadline_ticks: int | None, end: Verdict
) -> Outcome:
    """Whether the outcome of these signals is the naive one; 0 false, 1 true, 2 unknown."""
    certain = Signals(**{name: [code == 1 for code in values] for name, values in codes.items()})
    possible = Signals(**{name: [code != 0 for code in values] for name, values in codes.items()})
    columns = {name: column(values) for name, values in codes.items()}
    found, expected = (
        outcome_of(columns, ticks, deadline_ticks, end),
        naive(certain, possible, deadline_ticks, end),
    )
    assert found == expected
    assert found.as_json() == expected.as_json()
    for field in fields(Outcome):
        lazy, eager = getattr(found, field.name), getattr(expected, field.name)
        assert (repr(lazy), hash(lazy)) == (repr(eager), hash(eager))
        if isinstance(eager, tuple):
            assert len(lazy) == len(eager), field.name
    return found


ends = st.sampled_from([INCONCLUSIVE, VIOLATED])
horizons = st.none() | st.integers(0, 70) | st.just(10**15)


@st.composite
def signal_codes(draw: st.DrawFn) -> dict[str, bytes]:
    """Each signal true with a chance of its own, and unknown with another one."""
    ticks = draw(st.sampled_from([0, 1, 63, 64, 65]) | st.integers(0, 80))
    choose = random.Random(draw(st.integers(0, 10**6)))
    few = draw(st.sampled_from([0, 0.02, 0.3]))

    def values(share: float) -> bytes:
        return bytes(2 if choose.random() < few else choose.random() < share for _ in range(ticks))

    chances = st.sampled_from([0, 0.05, 0.3, 0.9, 1])
    return {name: values(draw(chances)) for name in Signals._fields}


@given(signal_codes(), horizons, ends)
def test_the_outcome_is_what_its_fields_mean(
    codes: dict[str, bytes], deadline_ticks: int | None, end: Verdict
) -> None:
    hold_to_the_definition(codes, len(codes["trigger"]), deadline_ticks, end)


@pytest.mark.slow
@pytest.mark.parametrize("deadline_ticks", [None, 0, 5, 300])
def test_the_outcome_of_a_long_trace_is_what_its_fields_mean(deadline_ticks: int | None) -> None:
    choose, ticks = random.Random(7), 20_000
    chances = {"obligation_pending": 0.97, "answer": 0.05, "trigger": 0.2}
    codes = {
        name: bytes(
            2 if choose.random() < 0.001 else choose.random() < chances.get(name, 0.01)
            for _ in range(ticks)
        )
        for name in Signals._fields
    }
    outcome = hold_to_the_definition(codes, ticks, deadline_ticks, INCONCLUSIVE)
    assert len(outcome.answers) > 100
    assert outcome.uncertain or deadline_ticks == 0


def test_what_nobody_reads_takes_no_memory() -> None:
    ticks = LARGE
    alternating = int("01" * (ticks // 2), 2)
    signals = {name: Column(0, 0) for name in Signals._fields}
    signals |= {"trigger": Column((1 << ticks) - 1, 0), "violation": Column(alternating, 0)}
    signals |= {"obligation_pending": Column(alternating << 1, 0), "answer": Column(alternating, 0)}
    outcome_of(signals, ticks, None)
    tracemalloc.start()
    try:
        outcome = outcome_of(signals, ticks, None)
        assert (outcome.verdict, outcome.first_violation) == ("violated", 0)
        counts = len(outcome.triggers), len(outcome.answers), len(outcome.violations)
        assert counts == (ticks, ticks - 1, ticks // 2)
        now, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert now < 10 * ticks / 8, "more than some columns"
    assert most < 20 * ticks / 8, "more than some columns"
