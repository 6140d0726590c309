"""Truth values at ticks over a window of few samples, in lists instead of arrays.

The steps are those of `fretc.logs.signals.propositions.evaluate` over the same window, and the
truth values those of `fretc.logs.signals.traces.proposition_states`, without late messages. Times
are nanoseconds.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection, Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from fretc.logs.signals.measures import ExpressionError
from fretc.logs.signals.propositions import FALSE, TRUE, UNKNOWN, outermost_persistences
from fretc.logs.windows.sample_queue import SampleQueue
from fretc.logs.windows.truth_functions import (
    NoFunctionError,
    NumberType,
    TruthFunction,
    truth_function,
)
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate, Declarations, Proposition
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Truth

_VALUES: tuple[Truth, ...] = (False, None, True)
_NAN = float("nan")


@dataclass(frozen=True, slots=True)
class Window:
    """The time that the samples of a stream cover."""

    begin: int
    """The first message of the stream."""
    before: int
    """The last tick before the new ones; it is not before `begin`."""
    lost: int
    """The end of the last gap, which is before the samples; -1: there is none."""


@dataclass(frozen=True, slots=True)
class _Steps:
    """The states from each time on; both of shape (n,), n >= 1, with increasing times."""

    times: list[int]
    states: list[int]


@dataclass(frozen=True, slots=True)
class _Values:
    """The values of signals from each time on, a list for each signal; NaN: unknown."""

    times: list[int]
    values: tuple[list[float], ...]


@dataclass(frozen=True, slots=True)
class _Function:
    """An expression, with its outermost persistences and their durations."""

    states: TruthFunction
    parts: tuple[tuple[_Function, int], ...]


@dataclass(frozen=True, slots=True)
class _Member:
    """A proposition with its function."""

    name: str
    function: _Function
    aggregate: Aggregate
    on_unknown: Truth


@dataclass(slots=True)
class _Group:
    """Propositions of the same signals that look back equally long."""

    signals: tuple[str, ...]
    lookback: int
    members: list[_Member] = field(default_factory=list)
    values: tuple[float, ...] | None = None
    """The values in force when the truth values were last constant; None: they never were."""
    constants: dict[str, Truth] = field(default_factory=dict)
    """The truth values while these values are in force."""


class WindowTruth:
    """The propositions of a stream over its window."""

    def __init__(
        self,
        declarations: Declarations,
        queues: Mapping[str, SampleQueue],
        lookbacks: Mapping[str, int],
    ) -> None:
        """`lookbacks`: for each proposition the duration that it looks back."""
        self._queues = queues
        self._lookbacks = lookbacks
        self._propositions = {name: declarations.propositions[name] for name in lookbacks}
        self._kinds: list[np.dtype[Any] | None] = []
        self._groups: list[_Group] = []

    def truth(self, window: Window, ticks: Sequence[int]) -> dict[str, list[Truth]]:
        """The truth values of propositions at new ticks, whose times increase, each shape (ticks,).

        A proposition is left out if it has no function in Python, or if several samples of one of
        its signals in the window have the same time.
        """
        kinds = [queue.kind for queue in self._queues.values()]
        if kinds != self._kinds:
            self._kinds = kinds
            self._groups = self._all_groups()
        values = _WindowValues(self._queues, window.lost, ticks[-1])
        truths: dict[str, list[Truth]] = {}
        for group in self._groups:
            start = max(window.begin, window.before - group.lookback - 1)
            if not any(self._queues[signal].tied >= start for signal in group.signals):
                truths |= _truths(group, values.of(group.signals, start), window.before, ticks)
        return truths

    def _all_groups(self) -> list[_Group]:
        groups: dict[tuple[tuple[str, ...], int], _Group] = {}
        for name, proposition in self._propositions.items():
            function = self._function(proposition)
            if function is not None:
                key = proposition.signals, self._lookbacks[name]
                member = _Member(name, function, proposition.aggregate, proposition.on_unknown)
                groups.setdefault(key, _Group(*key)).members.append(member)
        return list(groups.values())

    def _function(self, proposition: Proposition) -> _Function | None:
        names = {name: _number_type(self._queues[name]) for name in proposition.signals}
        is_exact = any(each.kind.itemsize > _DOUBLE for each in names.values())
        if is_exact or ticks_back(proposition.expression):
            return None
        try:
            return _function(proposition.expression, names)
        except (NoFunctionError, ExpressionError, ValueError):
            return None


_DOUBLE = 8
"""Bytes of a 64-bit float."""


def _number_type(queue: SampleQueue) -> NumberType:
    kind = np.dtype(np.float32) if queue.value_kind is None else queue.value_kind
    return NumberType(kind, queue.signal.scale, queue.signal.values)


def _function(expression: e.Expression, names: Mapping[str, NumberType]) -> _Function:
    parts = tuple(dict.fromkeys(outermost_persistences(expression)))
    return _Function(
        truth_function(expression, names, parts),
        tuple((_function(part.arg, names), part.duration) for part in parts),
    )


# Values


class _WindowValues:
    """The values of signals up to an end, computed once for each start."""

    def __init__(self, queues: Mapping[str, SampleQueue], lost: int, end: int) -> None:
        self._queues, self._lost, self._end = queues, lost, end
        self._single: dict[tuple[str, int], _Values] = {}
        self._joint: dict[tuple[Collection[str], int], _Values] = {}

    def of(self, signals: tuple[str, ...], start: int) -> _Values:
        """The values of some signals at each time at which one of them may change."""
        if len(signals) == 1:
            return self._of(signals[0], start)
        key = signals, start
        joint = self._joint.get(key)
        if joint is None:
            each = [self._of(name, start) for name in signals]
            joint = self._joint[key] = _joined(each, start)
        return joint

    def _of(self, name: str, start: int) -> _Values:
        key = name, start
        single = self._single.get(key)
        if single is None:
            single = self._single[key] = _one(self._queues[name], self._lost, start, self._end)
        return single


def _one(queue: SampleQueue, lost: int, start: int, end: int) -> _Values:
    """The values of one signal: at the start, at its samples, and where one is too old."""
    times, values, max_age = queue.times, queue.values, queue.signal.max_age
    if queue.remembered is not None:
        times, values = queue.window(start, end, lost)
    first = bisect_right(times, start)
    stop = bisect_right(times, end, first)
    current = values[first - 1] if first and times[first - 1] > lost else _NAN
    if max_age is None:
        return _Values([start, *times[first:stop]], ([current, *values[first:stop]],))
    if first and start - times[first - 1] > max_age:
        current = _NAN
    if queue.interrupted > start:
        between = _with_expiries(queue, first, stop, start, max_age)
        at, known = [time for time, _ in between], [value for _, value in between]
    else:
        at, known = times[first:stop], values[first:stop]
    expiry = times[stop - 1] + max_age + 1 if stop else start
    if start < expiry <= end and (stop == len(times) or expiry < times[stop]):
        return _Values([start, *at, expiry], ([current, *known, _NAN],))
    return _Values([start, *at], ([current, *known],))


def _with_expiries(
    queue: SampleQueue, first: int, stop: int, start: int, max_age: int
) -> list[tuple[int, float]]:
    """Samples of a queue, and NaN where the one before is too old, after the start."""
    found: list[tuple[int, float]] = []
    expiry = queue.times[first - 1] + max_age + 1 if first else start
    for time, value in zip(queue.times[first:stop], queue.values[first:stop], strict=True):
        if start < expiry < time:
            found.append((expiry, _NAN))
        found.append((time, value))
        expiry = time + max_age + 1
    return found


def _joined(each: Sequence[_Values], start: int) -> _Values:
    """The values of several signals at the times of all of them."""
    if not each:
        return _Values([start], ())
    first = each[0].times
    if all(one.times == first for one in each[1:]):
        return _Values(first, tuple(one.values[0] for one in each))
    times = sorted({time for one in each for time in one.times})
    return _Values(times, tuple(_spread(one, times) for one in each))


def _spread(one: _Values, times: Sequence[int]) -> list[float]:
    """The values of a signal at more times."""
    (values,) = one.values
    if len(one.times) == len(times):
        return values
    spread, index, last = [], 0, len(one.times) - 1
    for time in times:
        if index < last and one.times[index + 1] <= time:
            index += 1
        spread.append(values[index])
    return spread


# Steps


def _steps(function: _Function, history: _Values, end: int, since: int | None = None) -> _Steps:
    """The states of a function up to an end, from the one in force at `since` on, or all."""
    if not function.parts:
        return _Steps(history.times, function.states(history.times, *history.values))
    parts = [
        _persistence(_steps(part, history, end), duration, end) for part, duration in function.parts
    ]
    times = sorted({*history.times, *(time for part in parts for time in part.times)})
    if since is not None:
        del times[: bisect_right(times, since) - 1]
    places = [bisect_right(history.times, time) - 1 for time in times] if history.values else ()
    columns = [[each[i] for i in places] for each in history.values]
    states = [_at(part, times) for part in parts]
    return _Steps(times, function.states(times, *columns, *states))


def _at(steps: _Steps, times: Sequence[int]) -> list[int]:
    """The states at times that are not before the first step."""
    own, states = steps.times, steps.states
    if times[0] >= own[-1]:
        return states[-1:] * len(times)
    return [states[bisect_right(own, time) - 1] for time in times]


def _persistence(arg: _Steps, duration: int, end: int) -> _Steps:
    """The truth of `arg` throughout `[t - duration, t]`; only changes are steps."""
    if arg.states.count(arg.states[0]) == len(arg.states):
        return _constant(arg.states[0], arg.times[0], duration, end)
    over = {FALSE: arg.times[0] - 1, UNKNOWN: arg.times[0] + duration, TRUE: 0}
    """For each state, the time from which on it is in no interval; unless it is the current one."""
    later = (time + duration for time in arg.times)
    times: list[int] = []
    states: list[int] = []
    index, last, current = -1, len(arg.times) - 1, UNKNOWN
    for time in sorted({*arg.times, *(time for time in later if time <= end)}):
        if index < last and arg.times[index + 1] == time:
            if index >= 0:
                over[current] = time + duration
            index += 1
            current = arg.states[index]
        state = TRUE
        if current == UNKNOWN or time < over[UNKNOWN]:
            state = UNKNOWN
        if current == FALSE or time < over[FALSE]:
            state = FALSE
        if not states or state != states[-1]:
            times.append(time)
            states.append(state)
    return _Steps(times, states)


def _constant(state: int, start: int, duration: int, end: int) -> _Steps:
    """`_persistence` of a state that does not change."""
    if state != TRUE:
        return _Steps([start], [state])
    if start + duration > end:
        return _Steps([start], [UNKNOWN])
    return _Steps([start, start + duration], [UNKNOWN, TRUE])


# Ticks


def _truths(
    group: _Group, history: _Values, before: int, ticks: Sequence[int]
) -> dict[str, list[Truth]]:
    """The truth value of each proposition of a group at each tick, by the steps since the last."""
    if any(one.function.parts for one in group.members):
        each = [(one, _steps(one.function, history, ticks[-1], before)) for one in group.members]
        return {
            one.name: _at_ticks(one, steps.states, _ranges(steps.times, before, ticks))
            for one, steps in each
        }
    if history.times[-1] > before:
        ranges = _ranges(history.times, before, ticks)
        return {
            one.name: _at_ticks(one, one.function.states(history.times, *history.values), ranges)
            for one in group.members
        }
    values = tuple([each[-1] for each in history.values])
    if values != group.values:
        last, columns = history.times[-1:], [each[-1:] for each in history.values]
        group.values = values
        group.constants = {
            one.name: _at_ticks(one, one.function.states(last, *columns), [(1, 1)])[0]
            for one in group.members
        }
    return {name: [truth] * len(ticks) for name, truth in group.constants.items()}


def _ranges(times: Sequence[int], before: int, ticks: Sequence[int]) -> list[tuple[int, int]]:
    """For each tick the range of the steps that it covers, end excluded."""
    begin, ranges = bisect_right(times, before), []
    for tick in ticks:
        end = bisect_right(times, tick, begin)
        ranges.append((begin, end))
        begin = end
    return ranges


def _at_ticks(
    member: _Member, states: Sequence[int], ranges: Sequence[tuple[int, int]]
) -> list[Truth]:
    """The truth value at each tick, from the steps that it covers, or else from the one before."""
    truths: list[Truth] = []
    for begin, end in ranges:
        if begin == end or member.aggregate is Aggregate.LAST:
            state = states[end - 1]
        elif member.aggregate is Aggregate.ANY:
            state = max(states[begin:end])
        else:
            state = min(states[begin:end])
        truths.append(member.on_unknown if state == UNKNOWN else _VALUES[state])
    return truths
