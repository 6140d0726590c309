"""What a log holds of the declared signals: the values that pass from reading to judging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fretish.diagnostic import Diagnostic
from monitors.integrity import EVERYTHING, Checked

Times = NDArray[np.int64]
"""Nanoseconds."""

Numbers = NDArray[np.float64]
"""NaN is unknown."""

Gap = tuple[int, int]
"""First and last nanosecond of a time whose messages are lost."""


@dataclass(frozen=True, slots=True)
class Samples:
    """One signal.

    `times` has shape (n,), nanoseconds that do not decrease; equal times stand in the order of
    the file. `values` has shape (n,), in the signal's base unit; NaN is unknown.
    """

    times: Times
    values: Numbers


@dataclass(frozen=True, slots=True)
class Topic:
    """How one topic of a log is, by the declared time (`log_time` where no signal reads it).

    `first_ns` and `last_ns` are None for a topic without messages, `median_period_ns` for one
    with less than two. `out_of_order` counts the messages that are earlier than one before them,
    `equal_stamps` those with the time of another, `unstamped` those without a stamp where the
    clock goes by stamps, `zero_stamps` those with a stamp that was never set, and `clock_jumps`
    those before which the clock jumped against the log times. All but the count are None where
    the messages were only counted.
    """

    name: str
    type: str
    encoding: str
    count: int
    first_ns: int | None
    last_ns: int | None
    longest_gap_ns: int | None
    out_of_order: int | None
    equal_stamps: int | None
    median_period_ns: int | None = None
    unstamped: int | None = 0
    zero_stamps: int | None = 0
    clock_jumps: int | None = 0


@dataclass(frozen=True, slots=True)
class Recording:
    """What one log holds of the declared signals.

    `start_ns` and `end_ns` are the times of the first and the last message of the topics that the
    bindings read, whichever signals were asked for, widened to the `gaps`. `ticks` are the times
    of the clock's topic, where the clock ticks by message. Each gap includes both its ends.
    `nearest` is, for signals that are the nearest of many readings, the least distance in metres
    that the sensor says it can report. `intact` is False when anything was found that could have
    lost messages.
    """

    name: str
    sha256: str
    size: int
    start_ns: int
    end_ns: int
    samples: Mapping[str, Samples]
    ticks: Times
    gaps: tuple[Gap, ...]
    topics: Mapping[str, Topic]
    nearest: Mapping[str, float]
    findings: tuple[Diagnostic, ...]
    intact: bool
    checked: Checked = EVERYTHING
