"""Signals of many messages at once: what `monitors.signals.sample` says of each of them.

Numbers are in the base unit of the signal's dimension; NaN is unknown.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fretish import expressions as e
from fretish.declarations import Reading, Reduce, Signal
from monitors.propositions import TRUE, Scope, truth
from monitors.samples import Numbers
from monitors.signals import clearance

Truths = NDArray[np.bool_]


def siblings(signal: Signal) -> tuple[str, ...]:
    """The fields beside the signal's own that are read with it, and must be there."""
    names = {name.id for name in e.names(signal.valid)} - {"x"} if signal.valid else set()
    if signal.reduce is Reduce.OUTLINE:
        names |= {"angle_min", "angle_increment"}
    return tuple(sorted(names))


def samples(signal: Signal, values: Numbers, beside: Mapping[str, Numbers]) -> Numbers:
    """The signal's value in each message.

    Args:
        signal: what to read, and how.
        values: shape (messages, elements), in the unit of the field; one element for a number.
        beside: each of `siblings`, shape (messages,).

    Returns:
        Shape (messages,).
    """
    factor = float(signal.unit.factor)
    index = signal.path.index
    if index is not None:
        values = values[:, index : index + 1]
    if not values.shape[1]:
        return np.full(len(values), np.nan)
    with np.errstate(all="ignore"):  # what is too large is infinite, and a NaN may signal
        readings, unknown = _readings(signal, values, _valid(signal, values, beside))
        found = _reduced(signal, readings, beside) * (
            1.0 if signal.reduce is Reduce.OUTLINE else factor
        )
    return np.where(unknown | np.isnan(readings).all(axis=1), np.nan, found)


def nearest(signal: Signal, stated: Numbers) -> float | None:
    """The least distance that the sensor can report, of `range_min` in each message."""
    finite = stated[np.isfinite(stated)]
    return float(finite.min()) * float(signal.unit.factor) if len(finite) else None


def _valid(signal: Signal, values: Numbers, beside: Mapping[str, Numbers]) -> Truths:
    """Which elements are measurements."""
    finite = np.isfinite(values)
    if signal.valid is None:
        return finite
    single = ((values.astype(np.float32) == values) | ~finite).all(axis=1)
    accepted = np.zeros(values.shape, bool)
    for rounded in (True, False):
        rows = single == rounded
        if rows.any():
            accepted[rows] = _accepted(signal, values[rows], beside, rows, single=rounded)
    return finite & accepted


def _accepted(
    signal: Signal, values: Numbers, beside: Mapping[str, Numbers], rows: Truths, *, single: bool
) -> Truths:
    assert signal.valid is not None
    count, width = values.shape
    names = {name.id for name in e.names(signal.valid)} - {"x"}
    numbers = {name: _spread(beside[name][rows], width) for name in names}
    scope = Scope(count * width, {"x": values.reshape(-1), **numbers}, signal.unit, single)
    accepted: Truths = (truth(signal.valid, scope) == TRUE).reshape(count, width)
    return accepted


def _spread(numbers: Numbers, width: int) -> Numbers:
    """One number for each element; one alone where all messages state the same."""
    same = len(numbers) > 0 and bool((numbers == numbers[0]).all())
    return numbers[:1] if same else np.repeat(numbers, width)


def _readings(signal: Signal, values: Numbers, valid: Truths) -> tuple[Numbers, Truths]:
    """The elements with what is far or near put in; and which messages are unknown."""
    invalid = signal.invalid
    readings, unknown = values.copy(), np.zeros(len(values), bool)
    for chosen, reading in (
        (np.isnan(values), invalid.nan),
        (np.isposinf(values), invalid.positive_infinity),
        (np.isneginf(values), invalid.negative_infinity),
        (np.isfinite(values) & ~valid, invalid.other),
    ):
        if reading is Reading.UNKNOWN:
            unknown |= chosen.any(axis=1)
        else:
            readings[chosen] = _PUT[reading]
    return readings, unknown


_PUT = {Reading.DROP: np.nan, Reading.FAR: np.inf, Reading.NEAR: -np.inf}


def _reduced(signal: Signal, readings: Numbers, beside: Mapping[str, Numbers]) -> Numbers:
    match signal.reduce:
        case None:
            return readings[:, 0]
        case Reduce.MIN:
            return np.asarray(np.fmin.reduce(readings, axis=1) + 0.0, np.float64)
        case Reduce.MAX:
            return np.asarray(np.fmax.reduce(readings, axis=1) + 0.0, np.float64)
        case Reduce.MEAN:
            return np.array([_mean(row) for row in readings])
        case Reduce.OUTLINE:
            starts, increments = beside["angle_min"], beside["angle_increment"]
            rows = zip(readings, starts, increments, strict=True)
            return np.array([_outline(signal, *row) for row in rows])


def _mean(readings: Numbers) -> float:
    measured = readings[~np.isnan(readings)]
    return float(measured.mean()) if len(measured) else float("nan")


def _outline(signal: Signal, readings: Numbers, start: float, increment: float) -> float:
    return clearance(signal, readings, float(start), float(increment))
