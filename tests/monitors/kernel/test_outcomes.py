"""Answers and open demands are certain where no value of what is unknown would change them."""

import functools
import random
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.kernel import Monitor, Outcome, evaluate
from monitors.kernel import outcomes as kernel_outcomes
from monitors.kernel.columns import columns_of, pieces_of
from monitors.kernel.outcomes import stepped
from monitors.kernel.verdicts import Truth
from tests.meaning import SCOPES
from tests.monitoring import monitor, packed
from tests.strategies import templates

EXACT = {
    "whenever p the sw shall within 2 ticks satisfy q": 20,
    "whenever p the sw shall eventually satisfy q": 20,
    "whenever p the sw shall for 2 ticks satisfy q": 0,
    "whenever p the sw shall at the next timepoint satisfy q": 0,
}
"""Sentences for which the rails are exact: each proposition comes once in what a demand needs.

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
@pytest.mark.parametrize("scope", SCOPES)
def test_what_is_said_to_be_certain_is_so_for_all_values_of_the_unknown(scope: str) -> None:
    for template in templates():
        if template.scope != scope:
            continue
        machine, choose = monitor(template.sentence), random.Random(repr(template))
        for _ in range(4):
            certain, right = certainties(machine, drawn(choose, tuple(machine.PROPOSITIONS), 6, 3))
            assert certain <= right, template


@pytest.mark.slow
@pytest.mark.parametrize("sentence", EXACT)
def test_what_is_certain_is_said_to_be(sentence: str) -> None:
    machine, choose = monitor(sentence), random.Random(sentence)
    certain_triggers = uncertain_triggers = 0
    for _ in range(120):
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
