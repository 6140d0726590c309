"""The clearance of one scan, equal to `fretc.logs.messages.vectorized.samples` of it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from math import cos, hypot, inf, isfinite, nan, sin

import numpy as np

from fretc.logs.messages.layouts import Location
from fretc.logs.messages.vectorized import (
    SLACK,
    TOO_FAR,
    FloatLimits,
    Singles,
    limits_of,
    samples,
    siblings,
)
from fretc.logs.signals.outline import distances, places
from fretc.logs.signals.samples import Numbers, scaled
from fretish.bindings.declarations import Reading, Reduce, Signal


def scan_reader(signal: Signal, location: Location) -> ScanReader | None:
    """The reader of a clearance in an array of 32-bit floats; None: it is another signal."""
    is_scan = signal.reduce is Reduce.OUTLINE and location.dtype == "<f4"
    return ScanReader(signal) if is_scan and location.count and signal.path.index is None else None


class ScanReader:
    """A reader of the clearances of one signal."""

    def __init__(self, signal: Signal) -> None:
        self._signal = signal
        self._stated: Mapping[str, float] = {}
        self._limits: FloatLimits | None = None
        self._angles: Numbers = np.zeros(0)
        corners = [*signal.footprint, signal.footprint[0]]
        self._edges = [(*a, *b) for a, b in pairwise(corners)]
        x, y, _ = signal.sensor
        self._reach = max(hypot(a - x, b - y) for a, b in signal.footprint) + SLACK

    def value(self, ranges: Singles, stated: Mapping[str, float]) -> float:
        """The clearance in metres; NaN: unknown.

        Args:
            ranges: shape (n,), in the unit of the field.
            stated: the number of each of `siblings`.
        """
        if stated != self._stated or len(ranges) != len(self._angles):
            self._read_stated(stated, len(ranges))
        value = None if self._limits is None else self._least(ranges, self._limits)
        if value is not None:
            return value
        beside = {name: np.array([stated[name]]) for name in siblings(self._signal)}
        return float(samples(self._signal, ranges[None, :], beside)[0])

    def _read_stated(self, stated: Mapping[str, float], count: int) -> None:
        """Read what consecutive scans have in common."""
        self._stated = stated
        beside = {name: np.array([number]) for name, number in stated.items()}
        start, increment = stated["angle_min"], stated["angle_increment"]
        with np.errstate(all="ignore"):
            self._limits = limits_of(self._signal, beside, 1)
            self._angles = start + increment * np.arange(count, dtype=float)
        if not all(map(isfinite, (start, increment, start + increment * count))):
            self._limits = None

    def _least(self, ranges: Singles, limits: FloatLimits) -> float | None:
        """The clearance if a beam was measured, and no other one is nearer or too far away."""
        measured = limits.hold(ranges[None, :])[0]
        if not measured.all():
            if not measured.any():
                return None
            meaning = self._meaning_of(ranges[~measured])
            if Reading.NEAR in meaning:
                return None
            if Reading.UNKNOWN in meaning:
                return nan
            ranges = np.where(measured, ranges, np.float32(inf))
        metres = scaled(ranges.astype(np.float64), self._signal.unit.factor)
        first = int(metres.argmin())
        nearest = float(metres[first])
        if nearest < 0 or not _is_usual(metres):
            return None
        near = np.flatnonzero(metres <= self._bound(nearest, first))
        ends = places(metres[near], self._angles[near], self._signal.sensor)
        return float(distances(ends, self._signal.footprint).min())

    def _bound(self, nearest: float, beam: int) -> float:
        """The length of a beam, in metres, from which on no end can be the nearest."""
        x, y, yaw = self._signal.sensor
        angle = float(self._angles[beam]) + yaw
        end = x + nearest * cos(angle), y + nearest * sin(angle)
        return min(_to_segment(*end, *edge) for edge in self._edges) + self._reach

    def _meaning_of(self, ranges: Singles) -> set[Reading]:
        """What the elements mean that are no measurements."""
        invalid = self._signal.invalid
        kinds = (
            (np.isnan(ranges), invalid.nan),
            (np.isposinf(ranges), invalid.positive_infinity),
            (np.isneginf(ranges), invalid.negative_infinity),
            (np.isfinite(ranges), invalid.other),
        )
        return {reading for chosen, reading in kinds if chosen.any()}


def _is_usual(metres: Numbers) -> bool:
    """Whether no measured beam is too long for the outline's arithmetic."""
    longest = float(metres.max())
    if not isfinite(longest):
        longest = float(metres[np.isfinite(metres)].max())
    return longest < TOO_FAR


def _to_segment(x: float, y: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """The distance of a point to a segment, up to rounding."""
    ax, ay = x2 - x1, y2 - y1
    part = ((x - x1) * ax + (y - y1) * ay) / ((ax * ax + ay * ay) or 1.0)
    part = min(1.0, max(0.0, part))
    return hypot(x - x1 - part * ax, y - y1 - part * ay)
