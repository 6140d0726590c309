"""The samples of the declared signals in a log: the interface between reader and audit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction
from math import inf
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.integrity import EVERYTHING, Checked
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic

Times = NDArray[np.int64]
"""Nanoseconds."""

Numbers = NDArray[np.float64]
"""Numbers; NaN is unknown."""

Values = NDArray[np.floating[Any]]
"""Numbers as recorded, NaN is unknown: 32-bit floats, 64-bit floats, or `EXACT` numbers."""

EXACT = np.dtype(np.longdouble)
"""80-bit floats: they hold each whole number of 64 bits and each float. They are used if whole
numbers of 2^53 and more were recorded."""

WHOLE = 2**53
"""The number from which on 64-bit floats do not hold every whole number."""

Gap = tuple[int, int]
"""First and last nanosecond of an interval with lost messages."""


_Number = TypeVar("_Number", float, Numbers)
_Whole = TypeVar("_Whole", bound=np.integer[Any])


def distinct(values: NDArray[_Whole]) -> NDArray[_Whole]:
    """Each value once, in order. NumPy's `unique` would import its masked arrays, for 9 ms."""
    ordered = np.sort(values)
    first = np.append(True, ordered[1:] != ordered[:-1])[: len(ordered)]
    once: NDArray[_Whole] = ordered[first]
    return once


def scaled(value: _Number, scale: Fraction) -> _Number:
    """`value * scale`, rounded once if a division or a multiplication alone does it."""
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers become infinite
        if scale.numerator == 1:
            return value / _float(scale.denominator)
        return value * _float(scale.numerator) / _float(scale.denominator)


def _float(number: int) -> float:
    """The nearest float of a number above 0; infinite if the number is too large."""
    try:
        return float(number)
    except OverflowError:
        return inf


def widest(values: NDArray[Any]) -> Values:
    """Numbers of any type as floats that hold them; 32-bit floats are unchanged."""
    if values.dtype == np.float32:
        return values.astype(np.float32, copy=False)
    integers = values.dtype.kind in "iu" and values.dtype.itemsize == 8 and values.size > 0
    if integers and (int(values.max()) >= WHOLE or int(values.min()) <= -WHOLE):
        return values.astype(EXACT)
    with np.errstate(invalid="ignore"):  # signalling NaN
        return values.astype(EXACT if values.dtype == EXACT else np.float64)


class NumberList:
    """A growing list of numbers, in the narrowest type that holds all of them."""

    def __init__(self) -> None:
        self._kind = np.dtype(np.float32)
        self._data = bytearray()

    def add(self, values: Values) -> None:
        """Append numbers."""
        kind = np.promote_types(self._kind, values.dtype)
        if kind != self._kind:
            self._data = bytearray(self.values().astype(kind).tobytes())
            self._kind = kind
        self._data += values.astype(kind, copy=False).tobytes()

    def values(self) -> Values:
        """All numbers."""
        return np.frombuffer(bytes(self._data), self._kind)


@dataclass(frozen=True, slots=True)
class Samples:
    """One signal.

    `times` has shape (n,), nanoseconds that do not decrease; equal times stand in the order of
    the file. `values` has shape (n,), as they were recorded; times `scale` they are in the base
    unit of the signal's dimension. NaN is unknown. Of a signal of words the values are places in
    `words`.
    """

    times: Times
    values: Values
    scale: Fraction = Fraction(1)
    words: tuple[str, ...] = ()

    @property
    def base(self) -> Numbers:
        """The values in the signal's base unit, as 64-bit floats."""
        return scaled(self.values.astype(np.float64), self.scale)


@dataclass(frozen=True, slots=True)
class Topic:
    """Statistics of one topic by the declared time (`log_time` where no signal reads it).

    `first_ns` and `last_ns` are None for a topic without messages, `median_period_ns` for one
    with less than two. `out_of_order` counts the messages out of order,
    `equal_stamps` those with the same time as another, `unstamped` those without a stamp where the
    clock goes by stamps, `zero_stamps` those with a stamp that was never set, and `clock_jumps`
    those before which the clock jumped against the log times. All but the count are None where
    the messages were only counted.
    """

    name: str
    type: str
    encoding: str
    count: int
    first_ns: int | None = None
    last_ns: int | None = None
    longest_gap_ns: int | None = None
    out_of_order: int | None = None
    equal_stamps: int | None = None
    median_period_ns: int | None = None
    unstamped: int | None = None
    zero_stamps: int | None = None
    clock_jumps: int | None = None


@dataclass(frozen=True, slots=True)
class Late:
    """Messages of a topic that were late for ticks: those from `firsts[i]` to `lasts[i]`.

    Both have shape (n,). What is late, and for which ticks, `monitors/ticking.py` says.
    """

    firsts: Times
    lasts: Times

    def at(self, ticks: Times) -> NDArray[np.bool_]:
        """At which ticks a message is missing, shape (ticks,)."""
        begun = np.sort(self.firsts).searchsorted(ticks, "right")
        over = np.sort(self.lasts).searchsorted(ticks, "left")
        return np.asarray(begun > over)

    def missed(self, ticks: Times) -> tuple[int, int]:
        """How many messages were late for any of the ticks, and how much later than allowed.

        Args:
            ticks: their times, in order.
        """
        first = ticks.searchsorted(self.firsts)
        late = first < len(ticks)
        late[late] &= ticks[first[late]] <= self.lasts[late]
        over = self.lasts[late] + 1 - ticks[first[late]]
        return int(late.sum()), int(over.max(initial=0))


@dataclass(frozen=True, slots=True)
class MentalState:
    """What an agent believes and pursues from a time on, by names in alphabetical order."""

    ns: int
    beliefs: tuple[str, ...]
    goals: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AgentTrace:
    """What an agent has reported of itself, in order of time; times are nanoseconds."""

    times: Times
    """Of all reports, shape (n,)."""
    states: tuple[MentalState, ...]
    """The first report, and each that differs from the one before."""
    actions: tuple[tuple[int, str], ...]
    """Time and name of each action."""


@dataclass(frozen=True, slots=True)
class Recording:
    """The declared signals in one log.

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
    beside: Mapping[str, Samples] = field(default_factory=dict)
    """Signals that were read for plots; no verdict and no diagnostic depends on them."""
    described: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """The values in the metadata of the log that labels use: `build.version` → values."""
    origin: int | None = None
    """Where the grid of ticks begins, as the watch that recorded the log says; None: none says it.
    """
    late: Mapping[str, Late] = field(default_factory=dict)
    """For each topic, its late messages, if the clock declares a lateness."""
    agents: Mapping[str, AgentTrace] = field(default_factory=dict)
    """What agents have reported, by their names; no verdict depends on it."""
    derived: dict[tuple[object, ...], Any] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )
    """A cache of values derived from this recording, shared by several readers."""
