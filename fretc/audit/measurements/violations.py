"""Violations with their context: trigger, deadline, missing response, and samples of the signals.

Times are nanoseconds, numbers are in base units.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from fretc.audit.measurements.beliefs import AgentBelief, agent_beliefs
from fretc.audit.measurements.intervals import Moment
from fretc.logs.agents.word_signals import word_signals
from fretc.logs.signals.enum_values import enum_value
from fretc.logs.signals.samples import Recording, Samples, Values, scaled
from fretish.classes.frozen import dataclass
from monitors.kernel import Column, Outcome

SURROUNDINGS = 2 * 10**9
"""Nanoseconds before the trigger and after the deadline for which evidence keeps samples."""
MOST_SAMPLES = 50
"""The most samples of one signal around one violation."""
EVEN_SAMPLES = MOST_SAMPLES - 3
"""The number of samples that are kept at even distances, if there are more than `MOST_SAMPLES`."""
MOST_WINDOWS = 100
"""The most violations of one run and requirement with their samples."""


@dataclass(frozen=True, slots=True)
class DemandText:
    """The demand of a requirement at each trigger, in words, and its deadline."""

    response: str = ""
    """The text of the expression that must be true, as the sentence writes it."""
    deadline_ticks: int | None = None
    """Ticks from a trigger to the latest response; None: there is no deadline."""


@dataclass(frozen=True, slots=True)
class BoundBeliefs:
    """The propositions of a requirement as an agent may believe them."""

    columns: Mapping[str, Column] = field(default_factory=dict)
    """Proposition → its truth at each tick."""
    names: Mapping[str, str] = field(default_factory=dict)
    """Proposition → the belief, where the names differ."""


NO_BELIEFS = BoundBeliefs()


@dataclass(frozen=True, slots=True)
class SampleWindow:
    """The samples around a violation, from `start_ns` to `end_ns`, both included."""

    start_ns: int
    end_ns: int
    samples: Mapping[str, Samples]
    """At most `MOST_SAMPLES` of each signal, with the least and the greatest of them; also what
    agents believe and do, as signals of words."""


@dataclass(frozen=True, slots=True)
class ViolationInterval:
    """An interval of ticks at which a demand was broken, with the samples of the signals."""

    first: Moment
    last: Moment
    trigger: Moment | None
    """The oldest trigger whose demand was broken; None: the demand has no trigger."""
    deadline: Moment | None
    """The last tick for the response; None: there is no deadline, or it is after the last tick."""
    missing: str
    """The response that is missing."""
    values: Mapping[str, float | str | None]
    """Each signal of the sentence at the first tick, a number in base units or an enumeration
    value; None: unknown."""
    window: SampleWindow | None
    """The samples around the violation; None after the first `MOST_WINDOWS`."""
    beliefs: tuple[AgentBelief, ...] = ()
    """What agents believed; empty after the first `MOST_WINDOWS`."""


def violations(
    outcome: Outcome,
    demand: DemandText,
    deadline_ticks: int | None,
    at: Callable[[int], Moment],
    recording: Recording,
    signals: Sequence[str],
    beliefs: BoundBeliefs = NO_BELIEFS,
) -> tuple[ViolationInterval, ...]:
    """Each interval of ticks at which the requirement was violated, in their order.

    Args:
        outcome: the outcome of the monitor.
        demand: the demand of the requirement.
        deadline_ticks: ticks after which a trigger demands nothing any more; None: never.
        at: the moment of a tick.
        recording: the recording with the samples of the signals.
        signals: the signals that the sentence reads.
        beliefs: the propositions that agents may believe.
    """
    answers, triggers = dict(outcome.answers), tuple(outcome.triggers)
    stretches = []
    for index, (first, last) in enumerate(outcome.violations):
        trigger = _cause(outcome, triggers, answers, deadline_ticks, first)
        deadline = (
            None
            if trigger is None or demand.deadline_ticks is None
            else trigger + demand.deadline_ticks
        )
        due = at(deadline) if deadline is not None and deadline < outcome.ticks else None
        begin, broken = None if trigger is None else at(trigger), at(first)
        window = (
            _window(
                begin if begin and deadline_ticks is not None else broken,
                due or broken,
                broken,
                recording,
                signals,
            )
            if index < MOST_WINDOWS
            else None
        )
        values = {name: value_at(recording, name, broken.ns) for name in signals}
        believed = (
            agent_beliefs(recording, beliefs.columns, beliefs.names, at, begin, broken)
            if window and recording.agents
            else ()
        )
        stretches.append(
            ViolationInterval(
                broken, at(last), begin, due, demand.response, values, window, believed
            )
        )
    return tuple(stretches)


def _cause(
    outcome: Outcome,
    triggers: Sequence[int],
    answers: Mapping[int, int],
    deadline_ticks: int | None,
    first: int,
) -> int | None:
    """The oldest trigger whose demand can be the one that is broken at tick `first`.

    It is one within `deadline_ticks` without an answer up to then; without a deadline, and if the
    demand is not open at the end either, the last trigger.
    """
    upto = bisect_right(triggers, first)
    if deadline_ticks is not None:
        oldest = bisect_right(triggers, first - deadline_ticks - 1)
        for trigger in triggers[oldest:upto]:
            if answers.get(trigger, first + 1) > first:
                return trigger
    if first == outcome.ticks - 1 and outcome.open and outcome.open[0][0] <= first:
        return outcome.open[0][0]
    return triggers[upto - 1] if upto else None


# Signals


def value_at(recording: Recording, signal: str, ns: int) -> float | str | None:
    """The last sample of a signal at or before a time; None: it is unknown, or there is none.

    Infinite values (nothing in range) are None too: JSON has no infinite numbers.
    """
    samples = recording.samples.get(signal)
    if samples is None:
        return None
    i = int(np.searchsorted(samples.times, ns, "right")) - 1
    if samples.words:
        return enum_value(float(samples.values[i]), samples.words) if i >= 0 else None
    value = scaled(float(samples.values[i]), samples.scale) if i >= 0 else float("nan")
    return value if np.isfinite(value) else None


def _window(
    trigger: Moment, due: Moment, broken: Moment, recording: Recording, signals: Sequence[str]
) -> SampleWindow:
    start = min(trigger.ns, broken.ns) - SURROUNDINGS
    end = max(due.ns, broken.ns) + SURROUNDINGS
    own = {name: recording.samples[name] for name in signals if name in recording.samples}
    samples = {
        name: _around(each, start, end, broken.ns)
        for name, each in (own | word_signals(recording.agents)).items()
    }
    return SampleWindow(start, end, samples)


def _around(samples: Samples, start: int, end: int, broken: int) -> Samples:
    """The samples of an interval of time, and the one in force at its start, thinned.

    The sample in force at the time `broken` is always among them: readers need its age.
    """
    first = max(0, int(np.searchsorted(samples.times, start, "right")) - 1)
    upto = int(np.searchsorted(samples.times, end, "right"))
    times, values = samples.times[first:upto], samples.values[first:upto]
    places = _thinned(values, max(0, int(np.searchsorted(times, broken, "right")) - 1))
    return Samples(times[places], values[places], samples.scale, samples.words)


def _thinned(values: Values, always: int) -> NDArray[np.intp]:
    """The indices of at most `MOST_SAMPLES` values: evenly, with the least and the greatest.

    Args:
        values: the values of one signal.
        always: the index of a value that is kept.
    """
    count = len(values)
    if count <= MOST_SAMPLES:
        return np.arange(count)
    even = np.linspace(0, count - 1, EVEN_SAMPLES).round().astype(np.intp)
    chosen = [always]
    if not np.isnan(values).all():
        chosen += [int(np.nanargmin(values)), int(np.nanargmax(values))]
    return np.unique(np.concatenate([even, np.array(chosen, np.intp)]))
