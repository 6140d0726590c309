"""Samples of signals with memory, computed from the recorded samples of a log."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fretc.logs.signals.samples import Gap, Samples, distinct
from fretish.bindings.declarations import Signal
from monitors.memory import Memory, remembered

CHOOSING = ("min", "max")
"""The functions whose values are samples; the others give 64-bit floats."""


def memory_of(signal: Signal) -> Memory | None:
    """The function with memory of a signal, as deployed code has it."""
    memory = signal.memory
    return None if memory is None else Memory(memory.function, memory.over, memory.max_age)


def with_memory(signal: Signal, samples: Samples, gaps: Sequence[Gap], end: int) -> Samples:
    """The samples of a signal up to an end; unchanged if it has no memory.

    Args:
        signal: the signal.
        samples: those of the field that it reads.
        gaps: the gaps of the recording.
        end: the last nanosecond of the recording.
    """
    memory = memory_of(signal)
    if memory is None:
        return samples
    times = samples.times
    changes = [times + after for after in memory.changes]
    others = distinct(np.concatenate([*changes, times[:0]]))
    others = others[(others <= end) & ~np.isin(others, times)]
    ends = np.append(np.arange(1, len(times) + 1), times.searchsorted(others, "right"))
    events = np.append(times, others)
    order = np.argsort(events, kind="stable")
    events = events[order]
    at, given = times.tolist(), [None if x != x else x for x in samples.values.tolist()]
    values = [
        remembered(memory, at, given, time, count, gaps)
        for time, count in zip(events.tolist(), ends[order].tolist(), strict=True)
    ]
    kind = samples.values.dtype if memory.function in CHOOSING else np.dtype(np.float64)
    numbers = [np.nan if value is None else value for value in values]
    return Samples(events, np.array(numbers, kind), samples.scale)
