"""The samples of a signal that a stream still needs."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import field
from math import isnan, nan
from typing import Any

import numpy as np

from fretc.logs.signals.enum_values import UnmappedSamples, shown
from fretc.logs.signals.memory import CHOOSING, memory_of
from fretc.logs.signals.samples import EXACT, Gap, Samples
from fretish.bindings.declarations import Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.memory import MemorySeries


@dataclass(slots=True)
class SampleQueue:
    """The samples of one signal, in order of time; those of equal times in order of arrival."""

    signal: Signal
    is_flag: bool
    """Whether the signal is a truth value."""
    times: list[int] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    kind: np.dtype[Any] | None = None
    """The number type; None: every sample is unknown."""
    count: int = 0
    """The number of samples so far."""
    foreign: UnmappedSamples | None = None
    """Samples that are not among the values of the signal, or not a truth value."""
    first_foreign: int = 0
    """The time of the first of them."""
    tied: int = -1
    """The latest time that several samples share; -1: none."""
    interrupted: int = -1
    """No sample after this time came when the one before it was too old; -1: none came so."""

    remembered: MemorySeries | None = None
    """The values of a signal with memory; None: it has none."""

    def __post_init__(self) -> None:
        """Begin the memory of the signal."""
        memory = memory_of(self.signal)
        if memory is not None:
            self.remembered = MemorySeries(memory)

    @property
    def value_kind(self) -> np.dtype[Any] | None:
        """The number type of the values; None: every one is unknown."""
        memory = self.signal.memory
        if memory is None or memory.function in CHOOSING:
            return self.kind
        return np.dtype(np.float64)

    def refusal(self, kind: np.dtype[Any] | None, passed: int) -> Diagnostic | None:
        """F421: in a wider number type, samples of judged ticks would compare differently."""
        if kind is None or self.kind is None or np.promote_types(self.kind, kind) == self.kind:
            return None
        if not self.times or self.times[0] >= passed:
            return None
        return diagnostic(
            "stream_types_differ",
            self.signal.span,
            signal=self.signal.name,
            before=_words(self.kind),
            now=_words(kind),
        )

    def put(self, time: int, value: float, kind: np.dtype[Any] | None, foreign: str) -> None:
        """Add one sample, after those of the same time; `foreign`: the text of an unmapped one."""
        if not foreign and self.is_flag and value not in (0, 1) and not isnan(value):
            foreign = shown(value)
        if foreign:
            self.first_foreign = time if self.foreign is None else self.first_foreign
            unmapped = UnmappedSamples(1, self.count, foreign)
            self.foreign = self.foreign.followed(unmapped) if self.foreign else unmapped
        self.count += 1
        if kind is not None and kind is not self.kind:
            self.kind = kind if self.kind is None else np.promote_types(self.kind, kind)
        if kind is None or kind.itemsize <= _DOUBLE:
            value = float(value)
        if self.remembered is not None:
            self.remembered.put(time, None if isnan(value) else value)
        index = bisect_right(self.times, time)
        if index and self.times[index - 1] == time:
            self.tied = max(self.tied, time)
        if self.signal.max_age is not None:
            self._interrupt(index, time, self.signal.max_age)
        self.times.insert(index, time)
        self.values.insert(index, value)

    def _interrupt(self, index: int, time: int, max_age: int) -> None:
        """Record that a new sample, or the one after it, comes after one that is too old."""
        if index and time - self.times[index - 1] > max_age:
            self.interrupted = max(self.interrupted, time)
        if index < len(self.times) and self.times[index] - time > max_age:
            self.interrupted = max(self.interrupted, self.times[index])

    def forget(self, start: int) -> None:
        """Drop the samples before the one that is in force when the window starts."""
        count = max(0, bisect_left(self.times, start) - 1)
        del self.times[:count]
        del self.values[:count]
        if self.remembered is not None:
            self.remembered.forget(start)

    def window(self, start: int, end: int, lost: int) -> tuple[list[int], list[float]]:
        """Times and values: the one in force at `start`, and those up to `end`.

        `lost` is the end of the last gap, which is before the window; -1: there is none.
        """
        series = self.remembered
        assert series is not None, "it has memory"
        first = max(0, bisect_right(series.times, start) - 1)
        stop = bisect_right(series.times, end, first)
        return series.times[first:stop], self._remembered(series, first, stop, ((0, lost),))

    def _remembered(
        self, series: MemorySeries, first: int, stop: int, gaps: Sequence[Gap]
    ) -> list[float]:
        values = (series.at(i, series.times[i], gaps) for i in range(first, stop))
        return [nan if value is None else value for value in values]

    def samples(self, gaps: Sequence[Gap] = (), end: int | None = None) -> Samples:
        """All remaining samples; of a signal with memory, its values up to an end.

        Args:
            gaps: those of the recording.
            end: the last time.
        """
        series = self.remembered
        if series is not None:
            stop = len(series.times) if end is None else bisect_right(series.times, end)
            remaining = self._remembered(series, 0, stop, gaps)
            return Samples(
                np.array(series.times[:stop], np.int64),
                np.array(remaining, self.value_kind or np.float32),
                self.signal.scale,
            )
        values = np.array(self.values, self.kind or np.float32)
        times = np.array(self.times, np.int64)
        return Samples(times, values, self.signal.scale, self.signal.values)


_DOUBLE = 8
"""Bytes of a 64-bit float."""
_WORDS = {4: "32-bit floats", 8: "64-bit floats", EXACT.itemsize: "whole numbers from 2^53 on"}


def _words(kind: np.dtype[Any]) -> str:
    return _WORDS[kind.itemsize]
