"""Signals with memory: values over the samples of a time that ends now.

A *window* is the time after `t - over`, up to and including `t`. A value is unknown unless the
signal that it reads was known throughout the window: a sample lies at or before its begin, no
sample is unknown or too old in it, and no gap of the recording touches it. Samples are in order of
time; equal times are in order of arrival. The text of this module is copied into emitted nodes: it
needs the standard library only.
"""

from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable, Mapping, Sequence
from math import fsum, isnan
from typing import NamedTuple

from monitors.kernel.readings import Reading
from monitors.proposition_evaluator import Series


class Memory(NamedTuple):
    """A function of the past of a signal."""

    function: str
    """`rate`, `mean`, `max`, `min` or `count`."""
    over: "int | None" = None
    """The length of the window in nanoseconds; None: `rate` of two successive samples."""
    max_age: "int | None" = None
    """The age in nanoseconds beyond which a sample of the signal is unknown."""

    @property
    def changes(self) -> "tuple[int, ...]":
        """How long after a sample the value may change because of it."""
        leaves = () if self.over is None or self.function == "rate" else (self.over,)
        return leaves if self.max_age is None else (*leaves, self.max_age + 1)


def remembered(
    memory: Memory,
    times: "Sequence[int]",
    values: "Sequence[Reading]",
    time: int,
    end: int,
    gaps: "Sequence[tuple[int, int]]" = (),
) -> Reading:
    """The value at a time; None: unknown.

    Args:
        memory: the function.
        times: the times of the samples, in nanoseconds.
        values: the samples.
        time: the time of the value.
        end: the number of samples that have come: `times[end - 1]` is the last one.
        gaps: first and last nanosecond of each gap of the recording.
    """
    if not end:
        return None
    last = times[end - 1]
    if memory.function == "rate":  # It changes at samples only.
        anchor = (
            bisect_left(times, last)
            if memory.over is None
            else bisect_right(times, last - memory.over, 0, end)
        )
    else:
        assert memory.over is not None, "only a rate has no window"
        anchor = bisect_right(times, time - memory.over, 0, end)
    anchor -= 1
    if anchor < 0 or not _is_known(memory, times, values, anchor, end, time):
        return None
    if any(first <= time and times[anchor] <= stop for first, stop in gaps):
        return None
    if memory.function == "rate":
        change = _float(values[end - 1]) - _float(values[anchor])
        rate = change / ((last - times[anchor]) / 10**9)
        return None if isnan(rate) else rate
    return _FUNCTIONS[memory.function](values[anchor + 1 : end])


def _is_known(
    memory: Memory,
    times: "Sequence[int]",
    values: "Sequence[Reading]",
    anchor: int,
    end: int,
    time: int,
) -> bool:
    """Whether the signal was known from a sample on until a time."""
    if None in values[anchor:end]:
        return False
    if memory.max_age is None:
        return True
    most, known = memory.max_age, times[anchor:end]
    # A sample that comes in the nanosecond in which the one before is too old replaces it.
    return time - known[-1] <= most and all(
        known[i + 1] - known[i] <= most + 1 for i in range(len(known) - 1)
    )


def _float(reading: Reading) -> float:
    assert reading is not None, "it is known"
    try:
        return float(reading)
    except OverflowError:
        return float("inf")


def _mean(values: "Sequence[Reading]") -> Reading:
    """The exact sum as the nearest 64-bit float, divided by their number."""
    if not values:
        return None
    numbers = [_float(value) for value in values]
    try:
        mean = fsum(numbers) / len(numbers)
    except OverflowError:
        mean = fsum(number / len(numbers) for number in numbers)
    except ValueError:  # It has both infinities.
        return None
    return mean


def _count(values: "Sequence[Reading]") -> Reading:
    if any(value not in (0, 1) for value in values):
        return None
    return float(sum(value == 1 for value in values))


def _greatest(values: "Sequence[Reading]") -> Reading:
    return max((value for value in values if value is not None), default=None)


def _least(values: "Sequence[Reading]") -> Reading:
    return min((value for value in values if value is not None), default=None)


_FUNCTIONS: "Mapping[str, Callable[[Sequence[Reading]], Reading]]" = {
    "mean": _mean,
    "max": _greatest,
    "min": _least,
    "count": _count,
}
"""Name -> function of the known samples in a window."""


class MemorySeries(Series):
    """The values of a signal with memory.

    It has a value at each sample, where a sample leaves the window, and where one is too old.
    """

    def __init__(self, memory: Memory) -> None:
        super().__init__()
        self.memory = memory
        self._samples = Series()

    def put(self, time: int, value: Reading) -> None:
        """Add a sample of the signal that is read."""
        first, end = self._samples.span(time)
        if first < end or not self._is_event(time):
            insort(self.times, time)
        self._samples.put(time, value)
        for after in self.memory.changes:
            if not self._is_event(time + after):
                insort(self.times, time + after)

    def _is_event(self, time: int) -> bool:
        index = bisect_left(self.times, time)
        return index < len(self.times) and self.times[index] == time

    def forget(self, start: int) -> None:
        """Drop what no value from `start` on needs; `over` is taken into account."""
        count = max(0, bisect_left(self.times, start) - 1)
        del self.times[:count]
        if not self.times:
            return
        times, begin = self._samples.times, min(start, self.times[0])
        latest = bisect_right(times, begin) - 1
        if latest >= 0:  # A rate looks back from the last sample.
            begin = times[latest]
        needed = begin - (self.memory.over or 0)
        current = bisect_left(times, needed) - 1
        if current > 0:  # A rate also needs the sample before.
            self._samples.forget(times[current])
            # `forget` keeps the sample before the one at that time.

    def at(self, index: int, time: int, gaps: "Sequence[tuple[int, int]]" = ()) -> Reading:
        """The value with an index; it stays until the next one."""
        if index < 0:
            return None
        event = self.times[index]
        first, end = self._samples.span(event)
        if first < end:
            # The first of equal times may be forgotten, so they are counted from the last.
            end = max(first + 1, end + 1 + index - bisect_right(self.times, event))
        samples = self._samples
        return remembered(self.memory, samples.times, samples.values, event, end, gaps)
