"""Propositions over samples: three-valued step functions of time.

Kleene's logic: a proposition is true, false or unknown, and unknown operands stay unknown until the
others decide. Times are nanoseconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.measures import ExpressionError, NameValues, Term, compared, term
from fretc.logs.signals.samples import Recording, Samples, Times, Values, distinct
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Proposition, Signal
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass
from fretish.reading.caching import cache_by_identity

States = NDArray[np.int8]
"""Shape (n,), of `FALSE`, `UNKNOWN` and `TRUE`: `and` is their minimum, `or` their maximum."""

FALSE, UNKNOWN, TRUE = 0, 1, 2
_VALUES: tuple[bool | None, ...] = (False, None, True)
_FOREVER = 2**62
"""Later than any time of a log, and far enough from the end of int64 to add a duration."""


@dataclass(frozen=True, slots=True)
class StepFunction:
    """A step function: `states[i]` from `times[i]` on, until `times[i + 1]`.

    Both have shape (n,), n >= 1. Times do not decrease; of several steps at one time each was
    seen and the last one stays.
    """

    times: Times
    states: States

    @property
    def values(self) -> list[bool | None]:
        """The states as truth values; None is unknown."""
        return truth_values(self.states)


def truth_values(states: States) -> list[bool | None]:
    """`FALSE`, `UNKNOWN`, `TRUE` as False, None, True."""
    return [_VALUES[state] for state in states.tolist()]


def evaluate(
    proposition: Proposition, declarations: Declarations, recording: Recording
) -> StepFunction:
    """The proposition's truth over the time of the recording.

    A step is taken at the start of the recording, at each sample of each signal that the
    proposition names, where a sample grows too old (`max_age` and one nanosecond after it), at
    both ends of each gap of the recording, and where `... for 200 ms` is fulfilled. Samples with
    the same time are taken in their order: the first of each signal together, then the second.

    A signal is unknown before its first sample, after its last one has grown too old, within a
    gap and from there to the next sample, and where a sample is unknown. Samples are compared as
    they were recorded, in their own unit, with the nearest number of their kind: 0.9 as a 32-bit
    float is 0.9, and not below it.

    Returns:
        Steps from `recording.start_ns` on; the later ones up to `recording.end_ns`.
    """
    assert not ticks_back(proposition.expression), "it has a truth at ticks only"
    signals = {name: declarations.signals[name] for name in proposition.signals}
    key = (id(proposition), *_read(signals))
    cached: tuple[Proposition, StepFunction] | None = recording.derived.get(key)
    if cached is not None:
        return cached[1]
    steps = _steps(proposition.expression, history_of(signals, recording))
    last = max(recording.end_ns, recording.start_ns)
    count = int(np.searchsorted(steps.times, last, "right"))
    steps = StepFunction(steps.times[:count], steps.states[:count])
    if len(steps.times) <= _KEPT:
        recording.derived[key] = proposition, steps  # the reference keeps the id of the key valid
    return steps


# Truth at points


def truth(expression: e.Expression, scope: NameValues) -> States:
    """Kleene's truth of the expression at each point, shape (scope.length,).

    Raises:
        ExpressionError: the expression is a number, or names what the scope does not hold.
    """
    match expression:
        case e.Truth(value):
            return np.full(scope.length, TRUE if value else FALSE, np.int8)
        case e.Name(id):
            return _flag(id, scope)
        case e.Comparison(op, e.Name(id) as name, e.Word(text)) | e.Comparison(
            op, e.Word(text), e.Name(id) as name
        ):
            index = Fraction(scope.words[id].index(text))
            return _compared(op, term(name, scope), index, scope.length)
        case e.Comparison(op, left, right):
            return _compared(op, term(left, scope), term(right, scope), scope.length)
        case e.Not(arg):
            return _not(truth(arg, scope))
        case e.And(args):
            return reduce(np.minimum, (truth(arg, scope) for arg in args))
        case e.Or(args):
            return reduce(np.maximum, (truth(arg, scope) for arg in args))
        case e.Implies(left, right):
            return np.maximum(_not(truth(left, scope)), truth(right, scope))
        case e.Iff(left, right):
            return _same(truth(left, scope), truth(right, scope))
        case e.Xor(left, right):
            return _not(_same(truth(left, scope), truth(right, scope)))
        case e.Persistence():
            if expression not in scope.persistences:
                raise ExpressionError("`for` needs a proposition: a single message has no duration")
            return scope.persistences[expression]
        case _:
            raise ExpressionError("a truth value is needed, and this is a number")


def _flag(id: str, scope: NameValues) -> States:
    """A plain number as a truth value: 1 is true, 0 is false, any other number is unknown."""
    if id not in scope.numbers:
        raise ExpressionError(f"there is no `{id}`")
    numbers = scope.numbers[id]
    states = np.full(len(numbers), UNKNOWN, np.int8)
    states[numbers == 1] = TRUE
    states[numbers == 0] = FALSE
    return states if len(states) == scope.length else np.repeat(states, scope.length)


def _compared(op: str, left: Term, right: Term, length: int) -> States:
    true, unknown = compared(op, left, right)
    states = true.astype(np.int8)
    states *= TRUE  # all others become FALSE, which is 0
    if unknown.any():
        states[unknown] = UNKNOWN
    return states if len(states) == length else np.repeat(states, length)


def _not(states: States) -> States:
    return (TRUE - states).astype(np.int8)


def _same(left: States, right: States) -> States:
    unknown = (left == UNKNOWN) | (right == UNKNOWN)
    return np.where(unknown, UNKNOWN, np.where(left == right, TRUE, FALSE)).astype(np.int8)


# Signals over time


@dataclass(frozen=True, slots=True)
class History:
    """The signals of a proposition at all its events, with values as in `Samples`; shape (n,)."""

    times: Times
    numbers: Mapping[str, Values]
    scales: Mapping[str, Fraction]
    words: Mapping[str, tuple[str, ...]]

    def with_times(self, times: Sequence[Times]) -> History:
        """The history with further events at these times."""
        if not any(map(len, times)):
            return self
        extra = distinct(np.concatenate(times))
        before = np.searchsorted(self.times, extra), np.searchsorted(self.times, extra, "right")
        extra = extra[before[0] == before[1]]
        if not len(extra):
            return self
        in_force = np.searchsorted(self.times, extra, "right") - 1
        chosen = np.concatenate([np.arange(len(self.times)), in_force])
        every = np.concatenate([self.times, extra])
        order = np.argsort(every, kind="stable")
        numbers = {name: values[chosen[order]] for name, values in self.numbers.items()}
        return replace(self, times=every[order], numbers=numbers)

    def scope(
        self, persistences: Mapping[e.Persistence, States] = MappingProxyType({})
    ) -> NameValues:
        """The values of the names at the events."""
        return NameValues(
            len(self.times),
            self.numbers,
            scales=self.scales,
            persistences=persistences,
            words=self.words,
        )


def history_of(signals: Mapping[str, Signal], recording: Recording) -> History:
    """The signals at each time that `evaluate` needs."""
    key = _read(signals)
    history: History | None = recording.derived.get(key)
    if history is None:
        history = _history_of(signals, recording)
        if len(history.times) <= _KEPT:
            recording.derived[key] = history
    return history


_KEPT = 2**17
"""The most events of a history in the cache; larger histories are computed again."""


def _read(signals: Mapping[str, Signal]) -> tuple[object, ...]:
    """All inputs of a history other than the recording."""
    return tuple((name, signal.max_age, signal.values) for name, signal in signals.items())


def _history_of(signals: Mapping[str, Signal], recording: Recording) -> History:
    samples = {name: recording.samples.get(name, _NONE) for name in signals}
    gaps = _merged(recording.gaps)
    fixed = [recording.start_ns, *(edge for gap in gaps for edge in gap)]
    sources = [distinct(np.array(fixed, np.int64))]
    for name, signal in signals.items():
        sources += [samples[name].times, _expiries(samples[name].times, signal.max_age)]
    times, places = _events(sources)
    numbers = {
        name: _values_at(samples[name], places[1 + 2 * i], times, signal.max_age, gaps)
        for i, (name, signal) in enumerate(signals.items())
    }
    first = int(np.searchsorted(times, recording.start_ns))
    return History(
        times[first:],
        {name: values[first:] for name, values in numbers.items()},
        {name: samples[name].scale for name in signals},
        {name: signal.values for name, signal in signals.items()},
    )


_NONE = Samples(np.zeros(0, np.int64), np.zeros(0))


def _merged(gaps: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """The same gaps, merged where they touch or overlap, in order."""
    merged: list[tuple[int, int]] = []
    for start, end in sorted(gaps):
        if merged and start <= merged[-1][1]:
            merged[-1] = merged[-1][0], max(end, merged[-1][1])
        else:
            merged.append((start, end))
    return merged


def _expiries(times: Times, max_age: int | None) -> Times:
    """The times at which a sample is too old and no newer one has come."""
    if max_age is None or not len(times):
        return np.zeros(0, np.int64)
    following = np.append(times[1:], _FOREVER)
    expiries: Times = times + (max_age + 1)
    return expiries[expiries < following]


def _events(sources: Sequence[Times]) -> tuple[Times, list[NDArray[np.intp]]]:
    """All times, in order, and for each source the indices of its own times.

    The n-th of equal times of one source is merged with the n-th of the others.
    """
    times = np.concatenate(sources)
    ranks = np.concatenate([_ranks(source) for source in sources])
    order = np.lexsort((ranks, times)) if ranks.any() else np.argsort(times, kind="stable")
    times, ranks = times[order], ranks[order]
    new = np.ones(len(times), bool)
    new[1:] = (times[1:] != times[:-1]) | (ranks[1:] != ranks[:-1])
    place = np.empty(len(times), np.intp)
    place[order] = np.cumsum(new) - 1
    ends = np.cumsum([len(source) for source in sources])
    return times[new], np.split(place, ends[:-1])


def _ranks(times: Times) -> NDArray[np.intp]:
    """The number of equal times before each one; the times are in order."""
    places = np.arange(len(times))
    new = times[1:] != times[:-1]
    if new.all():
        return places * 0
    return places - np.maximum.accumulate(places * np.append(True, new))


def _values_at(
    samples: Samples,
    places: NDArray[np.intp],
    times: Times,
    max_age: int | None,
    gaps: Sequence[tuple[int, int]],
) -> Values:
    """The value of one signal at each event; NaN: unknown."""
    sample_times, values = samples.times, samples.values
    if not len(sample_times):
        return np.full(len(times), np.nan)
    here = np.zeros(len(times), np.intp)
    here[places] = 1
    last = here.cumsum() - 1
    sample_times, values = sample_times[last], values[last]
    unknown = last < 0
    if max_age is not None:
        unknown |= times - sample_times > max_age
    if gaps:
        starts, ends = np.array(gaps, np.int64).T
        gap = np.searchsorted(starts, times, "right") - 1
        unknown |= (gap >= 0) & ((times <= ends[gap]) | (sample_times <= ends[gap]))
    result: Values = np.where(unknown, values.dtype.type(np.nan), values)
    return result


# Durations


def _steps(expression: e.Expression, history: History) -> StepFunction:
    history, states = with_persistences(expression, history)
    return StepFunction(history.times, truth(expression, history.scope(states)))


def with_persistences(
    expression: e.Expression, history: History
) -> tuple[History, Mapping[e.Persistence, States]]:
    """The history with the events of each `... for 200 ms`, and its states at all events."""
    persistences = {
        part: _persistence(_steps(part.arg, history), part.duration)
        for part in outermost_persistences(expression)
    }
    if not persistences:
        return history, {}
    history = history.with_times([steps.times for steps in persistences.values()])
    return history, {part: _at(steps, history.times) for part, steps in persistences.items()}


@cache_by_identity
def outermost_persistences(expression: e.Expression) -> tuple[e.Persistence, ...]:
    """The outermost `... for 200 ms` in the expression."""
    if isinstance(expression, e.Persistence):
        return (expression,)
    return tuple(
        duration for part in e.children(expression) for duration in outermost_persistences(part)
    )


def _at(steps: StepFunction, times: Times) -> States:
    """The states of the step function at times that are not before its first step."""
    return steps.states[np.searchsorted(steps.times, times, "right") - 1]


def _persistence(arg: StepFunction, duration: int) -> StepFunction:
    """The truth of `arg` throughout `[t - duration, t]`.

    False if it was false within the interval, else unknown if it was unknown within it (as it is
    before the log), else true. Only changes are steps.
    """
    ends = np.append(arg.times[1:], _FOREVER)
    begins = np.append(arg.times[:1], ends[:-1])  # the earliest times at which it can become true
    times = distinct(np.concatenate([arg.times, begins + duration]))
    states = np.full(len(times), TRUE, np.int8)
    states[times < arg.times[0] + duration] = UNKNOWN
    for state in (UNKNOWN, FALSE):
        having = arg.states == state
        states[_reached(times, arg.times[having], ends[having] + duration)] = state
    changed = np.append(True, states[1:] != states[:-1])
    return StepFunction(times[changed], states[changed])


def _reached(times: Times, starts: Times, ends: Times) -> NDArray[np.bool_]:
    """Whether a time lies in one of the spans `start <= t < end`; both ends are in order."""
    if not len(starts):
        return np.zeros(len(times), bool)
    last = np.searchsorted(starts, times, "right") - 1
    return (last >= 0) & (times < ends[last])
