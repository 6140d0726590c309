"""Truth columns on the declared clock: the values of propositions at each tick of a recording.

Times are nanoseconds. None is unknown: neither true nor false.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.past_values import past_values
from fretc.logs.signals.propositions import (
    FALSE,
    TRUE,
    UNKNOWN,
    States,
    StepFunction,
    evaluate,
    truth_values,
)
from fretc.logs.signals.samples import Late, Recording, Times
from fretish.bindings.declarations import Aggregate, Declarations, Proposition
from fretish.classes.frozen import dataclass
from monitors import ticking
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class WholeTicks:
    """The whole ticks of one recording.

    `times` has shape (n,), the time of each tick in nanoseconds; it does not decrease. `period` is
    None if the clock ticks by message.
    """

    times: Times
    period: int | None


@dataclass(frozen=True, slots=True)
class Trace:
    """One column for each proposition: bit i is its truth at tick i.

    `cut` has the values at a tick that the end of the log cuts short: after the last whole tick. No
    duration counts it. None: the log ends with a whole tick.
    """

    timeline: WholeTicks
    columns: Mapping[str, Column]
    cut: Mapping[str, bool | None] | None


def trace(declarations: Declarations, recording: Recording, names: Collection[str]) -> Trace:
    """The propositions' truth at each tick.

    A tick sees what happened since the tick before: the steps after that tick's time, up to and
    including its own time; the first tick what happened since the log began, or, where the clock
    ticks by message, what happened at its own time. `any` of them makes it true, or
    else unknown if one of them is unknown; `all` makes it false, or else unknown; `last` is the
    last one. Without a step it sees what was in force before. `on_unknown` replaces what is then
    unknown. A proposition that looks back by ticks sees what is in force at each of them. Where a
    message of a topic that it reads was late, it is unknown, whatever `on_unknown` says.

    Args:
        declarations: clock, signals and propositions.
        recording: with the samples of all signals that the propositions name.
        names: of propositions that are declared.
    """
    ticks = timeline(declarations, recording)
    is_cut = len(ticks.times) > 0 and recording.end_ns > ticks.times[-1]
    times = np.append(ticks.times, recording.end_ns) if is_cut else ticks.times
    first = recording.start_ns if ticks.period is not None else None
    states = {
        name: proposition_states(name, declarations, recording, times, first) for name in names
    }
    count = len(ticks.times)
    columns = {name: packed(each[:count]) for name, each in states.items()}
    if not is_cut:
        return Trace(ticks, columns, None)
    return Trace(ticks, columns, {name: truth_values(s[-1:])[0] for name, s in states.items()})


def packed(states: States) -> Column:
    """The states, shape (ticks,), as one bit for each tick."""
    return Column(bits(states == TRUE), bits(states == UNKNOWN))


def bits(values: NDArray[np.bool_]) -> int:
    """Truth values, shape (ticks,), as an integer: bit i is the one at tick i."""
    return int.from_bytes(np.packbits(values, bitorder="little").tobytes(), "little")


def timeline(declarations: Declarations, recording: Recording) -> WholeTicks:
    """The whole ticks of the declared clock over the recording.

    Every `period` from the start on, not later than the last bound message; or one for each
    message of the clock's topic, and messages with the same time are a tick each. The start is
    the first bound message, or the first of the last topic to begin, where that is less than a
    tick later: recorders hear no two topics at once, and the first tick shall know all of them. The
    clock's phase is added to it.
    """
    period = declarations.clock.period
    if period is None:
        return WholeTicks(recording.ticks, None)
    start, phase = origin(declarations, recording, period), declarations.clock.phase
    count = (max(0, recording.end_ns - start) - phase) // period + 1
    return WholeTicks(start + phase + np.arange(count, dtype=np.int64) * period, period)


def origin(declarations: Declarations, recording: Recording, period: int) -> int:
    """The start of the tick grid at phase 0."""
    if recording.origin is not None:
        return recording.origin
    topics = {signal.path.topic for signal in declarations.signals.values()}
    firsts = (recording.topics[name].first_ns for name in topics if name in recording.topics)
    begun = [first for first in firsts if first is not None]
    return ticking.origin(recording.start_ns, begun, period)


def proposition_states(
    name: str, declarations: Declarations, recording: Recording, ticks: Times, first: int | None
) -> States:
    """The state of a proposition at each tick, shape (ticks,).

    `first` is the begin of the log, from which on the first tick covers the steps; None: it covers
    only the steps at its own time.
    """
    proposition = declarations.propositions[name]
    states = _timely_states(proposition, declarations, recording, ticks, first)
    for late in late_messages(proposition, declarations, recording):
        states[late.at(ticks)] = UNKNOWN
    return states


def late_messages(
    proposition: Proposition, declarations: Declarations, recording: Recording
) -> list[Late]:
    """The late messages of the proposition's topics, always with the clock's topic."""
    topics = {declarations.signals[name].path.topic for name in proposition.signals}
    topics |= {declarations.clock.topic} if declarations.clock.topic else set()
    return [late for topic, late in recording.late.items() if topic in topics]


def _timely_states(
    proposition: Proposition,
    declarations: Declarations,
    recording: Recording,
    ticks: Times,
    first: int | None,
) -> States:
    """The state at each tick if no message had been late."""
    past = past_values(proposition, declarations, recording)
    if past is not None:
        _, upto = _windows(past.times, ticks)
        return past.at(upto - 1)
    steps = evaluate(proposition, declarations, recording)
    begun = None if first is None else (first, complete_from(proposition, recording))
    return states_at(steps, ticks, proposition, begun)


def complete_from(proposition: Proposition, recording: Recording) -> int:
    """The time from which on unknown values count: all signals have begun, or messages are lost."""
    samples = [recording.samples.get(name) for name in proposition.signals]
    begins = [
        int(signal.times[0]) if signal is not None and len(signal.times) else recording.end_ns
        for signal in samples
    ]
    lost = min((start for start, _ in recording.gaps), default=recording.end_ns)
    return min(max(begins, default=recording.start_ns), lost)


def states_at(
    steps: StepFunction, ticks: Times, proposition: Proposition, begun: tuple[int, int] | None
) -> States:
    """The state of each tick, shape (ticks,).

    `begun` has the begin of the log, from which on the first tick covers the steps, and
    `complete_from`: an unknown value before the begin of a topic does not make the first tick
    unknown.
    """
    before, upto = _windows(steps.times, ticks)
    if begun is not None and len(ticks):
        before[:1] = first_before(steps, begun, upto[:1])
    return combined(steps, before, upto, proposition)


def first_before(
    steps: StepFunction, begun: tuple[int, int], upto: NDArray[np.intp]
) -> NDArray[np.intp]:
    """The first step that the first tick covers, of those below `upto`; `begun` as in `states_at`.

    It is the first step that is known or counts as unknown; if there is none, the last one.
    """
    first = int(steps.times.searchsorted(begun[0], "left"))
    informative = (steps.states[first:] != UNKNOWN) | (steps.times[first:] >= begun[1])
    start = first + int(np.argmax(informative)) if informative.any() else len(steps.times)
    return np.where(start < upto, start, np.maximum(first, upto - 1))


def combined(
    steps: StepFunction, before: NDArray[np.intp], upto: NDArray[np.intp], proposition: Proposition
) -> States:
    """The states of ticks with the steps `before <= i < upto`, each of shape (ticks,)."""
    states = steps.states
    result = np.where(before > 0, states[before - 1], UNKNOWN).astype(np.int8)
    filled = upto > before
    match proposition.aggregate:
        case Aggregate.ANY:
            result[filled] = FALSE
            result[filled & _some(states == UNKNOWN, before, upto)] = UNKNOWN
            result[filled & _some(states == TRUE, before, upto)] = TRUE
        case Aggregate.ALL:
            result[filled] = TRUE
            result[filled & _some(states == UNKNOWN, before, upto)] = UNKNOWN
            result[filled & _some(states == FALSE, before, upto)] = FALSE
        case Aggregate.LAST:
            result[filled] = states[upto[filled] - 1]
    if proposition.on_unknown is not None:
        result[result == UNKNOWN] = TRUE if proposition.on_unknown else FALSE
    return result


def _some(
    chosen: NDArray[np.bool_], before: NDArray[np.intp], upto: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Whether any of the steps `before <= i < upto` is selected."""
    if not chosen.any():
        return np.zeros(len(upto), bool)
    counts = np.concatenate([[0], np.cumsum(chosen)])
    return np.asarray(counts[upto] > counts[before])


def _windows(times: Times, ticks: Times) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """For each tick the steps `before <= i < upto` that it covers.

    Ticks with the same time share the steps of that time: the first tick has the first of them, the
    last tick has all that are left.
    """
    upto = times.searchsorted(ticks, "right")
    same = ticks[1:] == ticks[:-1]
    if same.any():
        rank = np.arange(len(ticks)) - ticks.searchsorted(ticks, "left")
        shared = times.searchsorted(ticks, "left") + rank + 1
        upto = np.where(np.append(same, False), np.minimum(shared, upto), upto)
    before = np.empty_like(upto)
    before[1:] = upto[:-1]
    before[:1] = times.searchsorted(ticks[:1], "left")
    return before, upto
