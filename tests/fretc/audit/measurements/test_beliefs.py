"""What an agent believed at a violation, against the definition, nanosecond by nanosecond."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.measurements.beliefs import PROMPT, AgentBelief, agent_beliefs
from fretc.audit.measurements.intervals import Moment
from fretc.logs.signals.samples import AgentTrace, Gap, MentalState, Recording
from monitors.kernel import Column
from tests.effort import examples
from tests.fretc.audit.test_one_log import FAR, MOVING, recorded

TICK = 10
"""Nanoseconds."""


def moment(tick: int) -> Moment:
    return Moment(tick, tick * TICK, tick * TICK / 1e9)


def column(truths: Sequence[bool | None]) -> Column:
    return Column(
        sum((value is True) << i for i, value in enumerate(truths)),
        sum((value is None) << i for i, value in enumerate(truths)),
    )


def log(reports: Sequence[tuple[int, bool]], gaps: tuple[Gap, ...] = ()) -> Recording:
    """`reports`: times at which the agent reports, and whether it believes `near`."""
    states: list[MentalState] = []
    for ns, believes in reports:
        beliefs = ("near",) if believes else ()
        if not states or states[-1].beliefs != beliefs:
            states.append(MentalState(ns, beliefs, ()))
    times = np.array([ns for ns, _ in reports], np.int64)
    trace = AgentTrace(times, tuple(states), ((reports[0][0], "go"),) if reports else ())
    return replace(recorded([FAR], [MOVING]), agents={"sw": trace}, gaps=gaps)


def beliefs(
    truths: Sequence[bool | None],
    reports: Sequence[tuple[int, bool]],
    trigger: int | None,
    broken: int,
    gaps: tuple[Gap, ...] = (),
) -> list[AgentBelief]:
    begin = None if trigger is None else moment(trigger)
    found = agent_beliefs(
        log(reports, gaps),
        {"close": column(truths)},
        {"close": "near"},
        moment,
        begin,
        moment(broken),
    )
    return list(found)


T, F = True, False
QUIET = [(0, F), (200, T)]
CASES = {
    "absent": ([F, T, T, T, T, T], [*QUIET], 1, 5, ("absent", 10, None)),
    "in time": ([F, T, T, T, T, T], [(0, F), (21, T)], 1, 5, ("in time", 10, 21)),
    "late": ([F, T, T, T, T, T], [(0, F), (31, T)], 1, 5, ("late", 10, 31)),
    "true before the trigger": ([T, T, T, T, T], [(0, F), (15, T)], 3, 4, ("in time", 0, 15)),
    "wrong": ([F, F, F, F, F], [(0, F), (25, T)], None, 4, ("wrong", None, 25)),
    "no longer true": ([T, T, F, F, F, F], [(0, T)], None, 5, ("wrong", None, 0)),
    "the trigger is over": ([F, T, F, F, F], [(0, F), (12, T), (22, F)], 1, 4, ("in time", 10, 12)),
}


@pytest.mark.parametrize("name", CASES)
def test_the_state_of_a_belief(name: str) -> None:
    truths, reports, trigger, broken, (state, true, believed) = CASES[name]
    (found,) = beliefs(truths, reports, trigger, broken)
    seconds = [None if ns is None else ns / 1e9 for ns in (true, believed)]
    assert (found.state, found.true_s, found.believed_s) == (state, *seconds)
    assert (found.agent, found.belief, found.proposition) == ("sw", "near", "close")
    assert (found.action, found.action_s) == ("go", 0.0)


@pytest.mark.parametrize(
    ("truths", "reports", "broken"),
    [
        ([F, F, F], [(0, F), (200, T)], 2),  # rightly not believed
        ([T, T, F], [(0, T)], 2),  # the agent has had no time
        ([F, F, None], [(0, T)], 2),  # unknown
        ([T, T, T], [(0, F)], 2),  # no belief of this agent
        ([T, T, T], [], 2),
    ],
)
def test_nothing_is_said_of_a_belief_that_explains_nothing(
    truths: list[bool | None], reports: list[tuple[int, bool]], broken: int
) -> None:
    assert beliefs(truths, reports, None, broken) == []


def test_nothing_is_said_where_a_report_may_be_lost() -> None:
    truths, reports = [F, F, T, T, T], [(0, F), (13, F), (200, T)]
    assert len(beliefs(truths, reports, None, 4, ((0, 12),))) == 1
    assert beliefs(truths, reports, None, 4, ((0, 13),)) == []
    assert beliefs(truths, reports, None, 4, ((40, 60),)) == []
    assert len(beliefs(truths, reports, None, 4, ((41, 60),))) == 1


def test_the_words_name_belief_time_report_and_action() -> None:
    about = ("sw", "near", "close")
    absent = AgentBelief(*about, "absent", 3.2, None, 3.1, None, None)
    assert absent.in_words() == (
        "`sw` did not believe `near`, which was true from 3.2 s; its last report is of 3.1 s; "
        "it had done nothing"
    )
    late = AgentBelief(*about, "late", 3.2, 4.0, 4.0, "halt", 4.1)
    assert late.in_words() == (
        "`sw` believed `near` only from 4 s, 800 ms after it became true; its last action was "
        "`halt`, at 4.1 s"
    )
    wrong = AgentBelief(*about, "wrong", None, 4.0, 4.0, "halt", 4.1)
    assert wrong.in_words().startswith("`sw` believed `near` from 4 s, and it was false; ")
    silent = AgentBelief(*about, "absent", 3.2, None, None, None, None)
    assert silent.in_words().endswith("true from 3.2 s, and had reported nothing")


TICKS = st.lists(st.sampled_from([True, False, None]), min_size=1, max_size=8)


@examples(300)
@given(TICKS, st.dictionaries(st.integers(0, 80), st.booleans(), max_size=8), st.data())
def test_the_state_is_what_the_definition_says(
    truths: list[bool | None], reported: dict[int, bool], data: st.DataObject
) -> None:
    broken = data.draw(st.integers(0, len(truths) - 1))
    begin = data.draw(st.integers(0, broken))
    reports = sorted(reported.items())
    found = beliefs(truths, reports, begin, broken)
    assert [(one.state, one.believed_s) for one in found] == [
        (state, None if ns is None else ns / 1e9)
        for state, ns in defined(truths, reports, begin, broken)
    ]


def defined(
    truths: Sequence[bool | None], reports: Sequence[tuple[int, bool]], begin: int, broken: int
) -> list[tuple[str, int | None]]:
    """The definition, by looking at each nanosecond."""
    end = broken * TICK
    if truths[broken] is None or not any(value for _, value in reports):
        return []

    def believed(ns: int) -> bool:
        return [F, *(value for at, value in reports if at <= ns)][-1]

    def since(ns: int) -> int:
        return next(t for t in range(ns, -1, -1) if t == 0 or not believed(t - 1))

    if truths[broken] or truths[begin]:
        first = broken if truths[broken] else begin
        while first and truths[first - 1] is True:
            first -= 1
        during = [ns for ns in range(first * TICK, end + 1) if believed(ns)]
        if not during:
            return [("absent", None)]
        is_late = during[0] > min((first + PROMPT) * TICK, end)
        return [("late" if is_late else "in time", since(during[0]))]
    first = broken
    while first and truths[first - 1] is False:
        first -= 1
    if not believed(end) or (since(end) < first * TICK and end <= (first + PROMPT) * TICK):
        return []
    return [("wrong", since(end))]
