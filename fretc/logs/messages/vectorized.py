"""Signals of many messages at once, equal to `fretc.logs.signals.signals.sample` of each.

Numbers are in the unit of the field, clearances in metres; NaN is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fretc.logs.mcap.payloads import Places
from fretc.logs.signals.measures import COMPARE, Measure, NameValues, term, together
from fretc.logs.signals.outline import distances, places
from fretc.logs.signals.propositions import TRUE, truth
from fretc.logs.signals.samples import EXACT, Numbers, Values, scaled
from fretc.logs.signals.signals import clearance, mean, unrounded
from fretish import expressions as e
from fretish.bindings.declarations import InvalidReadings, Reading, Reduce, Signal
from fretish.classes.frozen import dataclass
from fretish.expressions import MIRRORED
from fretish.reading.caching import cache_by_identity

Truths = NDArray[np.bool_]
Singles = NDArray[np.float32]


@cache_by_identity
def siblings(signal: Signal) -> tuple[str, ...]:
    """Further fields that the signal needs in addition to its own."""
    names = {name.id for name in e.names(signal.valid)} - {"x"} if signal.valid else set()
    if signal.reduce is Reduce.OUTLINE:
        names |= {"angle_min", "angle_increment"}
    return tuple(sorted(names))


def samples(signal: Signal, values: Values, sibling_values: Mapping[str, Numbers]) -> Values:
    """The signal's value in each message.

    Args:
        signal: the field to read, and the reduction.
        values: shape (messages, elements), as recorded; one element for a number.
        sibling_values: each of `siblings`, shape (messages,).

    Returns:
        Shape (messages,); times `signal.scale` it is in base units.
    """
    index = signal.path.index
    if index is not None:
        values = values[:, index : index + 1]
    if not values.shape[1]:
        return np.full(len(values), np.nan)
    result = np.empty(len(values), EXACT if values.dtype == EXACT else np.float64)
    with np.errstate(all="ignore"):  # too large numbers become infinite, and a NaN may signal
        if signal.reduce is None and signal.valid is None and np.isfinite(values).all():
            return values[:, 0]
        plain = _plain(signal, values, sibling_values, result)
        if not plain.all():
            rows = ~plain
            siblings_of_rows = {name: numbers[rows] for name, numbers in sibling_values.items()}
            result[rows] = _samples(signal, values[rows], siblings_of_rows)
    return result


def _plain(
    signal: Signal, values: Values, sibling_values: Mapping[str, Numbers], result: Values
) -> Truths:
    """Fill in the messages whose least or greatest measurement is easy to find.

    These are most messages: one element makes them unknown, or they have a measurement and no
    element takes precedence over it. Dropped elements never do, nor does far over the least, or
    near over the greatest.
    """
    if signal.reduce not in (Reduce.MIN, Reduce.MAX):
        return np.zeros(len(values), bool)
    limits = limits_of(signal, sibling_values, len(values))
    if limits is None or (signal.valid is not None and values.dtype != np.float32):
        return np.zeros(len(values), bool)
    unknown, stronger = (np.zeros(len(values), bool) for _ in range(2))
    for reading, chosen in _classes(signal.invalid, values, lambda: limits.hold(values)):
        if reading is Reading.UNKNOWN:
            unknown |= chosen().any(axis=1)
        elif reading not in (Reading.DROP, _WEAKER[signal.reduce]):
            stronger |= chosen().any(axis=1)
    ends, measured = _ends(signal.reduce, values, limits)
    plain: Truths = unknown | (measured & ~stronger)
    result[plain] = np.where(unknown, np.nan, ends.astype(result.dtype) + 0.0)[plain]
    return plain


def _ends(reduce: Reduce, values: Values, limits: FloatLimits) -> tuple[Values, Truths]:
    """The least or the greatest measurement of each message, and whether there is one."""
    least, band = reduce is Reduce.MIN, limits.band()
    if band is not None and values.dtype == np.float32:
        return _ends_within(band, values.view(np.uint32), least=least)
    # If the least of all numbers is a measurement, the other elements do not matter.
    ends = (np.fmin if least else np.fmax).reduce(values, axis=1)
    measured = limits.hold(ends[:, None])[:, 0]
    rows = np.flatnonzero(~measured)
    if len(rows):
        values_of_rows = values[rows]
        accepted = limits.hold(values_of_rows, rows)
        np.copyto(values_of_rows, np.inf if least else -np.inf, where=~accepted)
        ends[rows] = values_of_rows.min(axis=1) if least else values_of_rows.max(axis=1)
        measured[rows] = accepted.any(axis=1)
    return ends, measured


def _ends_within(
    band: tuple[Singles, Singles], patterns: NDArray[np.uint32], *, least: bool
) -> tuple[Singles, Truths]:
    """`_ends` of the bit patterns of 32-bit floats, where a measurement lies in a band above 0.

    The patterns of floats above 0 are in the order of the floats. Less than that of the lower end,
    modulo 2^32, those of all other floats (below it, negative, NaN) are beyond that of the upper
    end: so the least difference is that of the least measurement.
    """
    low, high = (end.view(np.uint32) for end in band)
    apart = (patterns - low if least else high - patterns).min(axis=1)
    ends = low[:, 0] + apart if least else high[:, 0] - apart
    return ends.view(np.float32), apart <= (high - low)[:, 0]


_WEAKER = {Reduce.MIN: Reading.FAR, Reduce.MAX: Reading.NEAR}
"""The reading that counts only if nothing was measured."""


def _classes(
    invalid: InvalidReadings, values: Values, valid: Callable[[], Truths]
) -> Iterator[tuple[Reading, Callable[[], Truths]]]:
    """Each kind of element that is not a measurement: its meaning, and its elements."""
    yield invalid.nan, lambda: np.isnan(values)
    yield invalid.positive_infinity, lambda: np.isposinf(values)
    yield invalid.negative_infinity, lambda: np.isneginf(values)
    yield invalid.other, lambda: np.isfinite(values) & ~valid()


@dataclass(frozen=True, slots=True)
class FloatLimits:
    """A test for measurements among 32-bit floats: each is finite, and compares as it should."""

    compared: Sequence[tuple[str, Singles]]
    """Operators and bounds: shape (messages, 1), or (1, 1) for all messages."""

    def hold(self, values: Values, rows: slice | NDArray[np.intp] = slice(None)) -> Truths:
        """The elements that are measurements, of all messages or of some."""
        accepted: Truths = np.isfinite(values)
        for op, bound in self.compared:
            accepted &= COMPARE[op](values, bound if len(bound) == 1 else bound[rows])
        return accepted

    def band(self) -> tuple[Singles, Singles] | None:
        """The least and the greatest float that is a measurement; None unless both are above 0."""
        low, high = np.zeros((1, 1), np.float32), np.full((1, 1), _GREATEST)
        for op, bound in self.compared:
            match op:
                case ">=":
                    low = np.maximum(low, bound)
                case ">":
                    low = np.maximum(low, np.nextafter(bound, np.float32(np.inf)))
                case "<=":
                    high = np.minimum(high, bound)
                case _:
                    high = np.minimum(high, np.nextafter(bound, np.float32(-np.inf)))
        return (low, high) if ((low > 0) & (low <= high)).all() else None


_GREATEST = np.finfo(np.float32).max


def limits_of(
    signal: Signal, sibling_values: Mapping[str, Numbers], count: int
) -> FloatLimits | None:
    """The test for measurements; None: comparisons with 32-bit floats are not enough."""
    bounds = [] if signal.valid is None else _bounds(signal.valid)
    if bounds is None:
        return None
    scope = NameValues(count, sibling_values, signal.field_unit)
    field = Measure(np.zeros(1, np.float32))
    compared: list[tuple[str, Singles]] = []
    for op, side in bounds:
        _, numbers, _ = together(field, term(side, scope))
        narrow = numbers.astype(np.float32)
        if not np.array_equal(narrow, numbers, equal_nan=True):
            return None
        same = bool((narrow == narrow[:1]).all())
        compared.append((op, narrow[:1, None] if same else narrow[:, None]))
    return FloatLimits(compared)


@cache_by_identity
def _bounds(valid: e.Expression) -> list[tuple[str, e.Expression]] | None:
    """The operators and bounds of `x >= range_min and x <= range_max`.

    None: the expression is not such a conjunction.
    """
    match valid:
        case e.And(args):
            parts = [_bounds(arg) for arg in args]
            return None if None in parts else [bound for part in parts if part for bound in part]
        case e.Comparison(op, left, right) if op in MIRRORED:
            if _is_x(left) and _without_x(right):
                return [(op, right)]
            if _is_x(right) and _without_x(left):
                return [(MIRRORED[op], left)]
    return None


def _is_x(part: e.Expression) -> bool:
    return isinstance(part, e.Name) and part.id == "x"


def _without_x(part: e.Expression) -> bool:
    return all(name.id != "x" for name in e.names(part))


def _samples(signal: Signal, values: Values, sibling_values: Mapping[str, Numbers]) -> Values:
    """`samples` for any elements."""
    valid = _valid(signal, values, sibling_values)
    readings, unknown = _readings(signal, unrounded(signal, values), valid)
    result = _reduced(signal, readings, sibling_values)
    return np.where(unknown | np.isnan(readings).all(axis=1), np.nan, result)


def nearest(signal: Signal, range_min: Numbers) -> float | None:
    """The least distance that the sensor can report, from `range_min` in each message."""
    finite = range_min[np.isfinite(range_min)]
    return scaled(float(finite.min()), signal.unit.factor) if len(finite) else None


def _valid(signal: Signal, values: Values, sibling_values: Mapping[str, Numbers]) -> Truths:
    """The elements that are measurements."""
    finite = np.isfinite(values)
    if signal.valid is None:
        return finite
    count, width = values.shape
    names = {name.id for name in e.names(signal.valid)} - {"x"}
    numbers = {name: _spread(sibling_values[name], width) for name in names}
    scope = NameValues(count * width, {"x": values.reshape(-1), **numbers}, signal.field_unit)
    accepted: Truths = (truth(signal.valid, scope) == TRUE).reshape(count, width)
    return finite & accepted


def _spread(numbers: Numbers, width: int) -> Numbers:
    """One number for each element; a single one if all messages state the same."""
    same = len(numbers) > 0 and bool((numbers == numbers[0]).all())
    return numbers[:1] if same else np.repeat(numbers, width)


def _readings(signal: Signal, values: Values, valid: Truths) -> tuple[Values, Truths]:
    """The elements with infinities for far and near, and the unknown messages."""
    invalid = signal.invalid
    readings, unknown = values.copy(), np.zeros(len(values), bool)
    for reading, chosen in _classes(invalid, values, lambda: valid):
        if reading is Reading.UNKNOWN:
            unknown |= chosen().any(axis=1)
        else:
            readings[chosen()] = _SUBSTITUTES[reading]
    return readings, unknown


_SUBSTITUTES = {Reading.DROP: np.nan, Reading.FAR: np.inf, Reading.NEAR: -np.inf}


def _reduced(signal: Signal, readings: Values, sibling_values: Mapping[str, Numbers]) -> Values:
    match signal.reduce:
        case None:
            return readings[:, 0]
        case Reduce.MIN:
            return np.asarray(np.fmin.reduce(readings, axis=1) + 0.0)
        case Reduce.MAX:
            return np.asarray(np.fmax.reduce(readings, axis=1) + 0.0)
        case Reduce.MEAN:
            return np.array([_mean(row) for row in readings])
        case Reduce.OUTLINE:
            return _clearances(
                signal,
                readings.astype(np.float64),
                sibling_values["angle_min"],
                sibling_values["angle_increment"],
            )


def _mean(readings: Values) -> float:
    measured = readings[~np.isnan(readings)]
    return mean(measured) if len(measured) else float("nan")


# The robot's outline

SLACK = 1e-6
"""Metres by which rounding could make a distance too small, many times over."""
TOO_FAR = 1e9
"""Metres; farther ends of beams could give too large numbers in between."""


def _clearances(signal: Signal, readings: Numbers, starts: Numbers, increments: Numbers) -> Numbers:
    """`clearance` of each message.

    A point is at most so much nearer to the outline than to the sensor as the farthest corner is
    from the sensor. So once the end of the nearest beam has been measured, most of the others are
    too far away to be nearer.
    """
    clearances = np.empty(len(readings))
    usual = _usual(signal, readings, starts, increments)
    for row in np.flatnonzero(~usual):
        clearances[row] = clearance(
            signal, readings[row], float(starts[row]), float(increments[row])
        )
    for rows in _same_directions(np.flatnonzero(usual), starts, increments):
        beams = np.arange(readings.shape[1], dtype=float)
        angles = starts[rows[0]] + increments[rows[0]] * beams
        clearances[rows] = _least(signal, scaled(readings[rows], signal.unit.factor), angles)
    return clearances


def _usual(signal: Signal, readings: Numbers, starts: Numbers, increments: Numbers) -> Truths:
    """The messages with a measurement, and without readings that are too large or too near."""
    last = starts + increments * readings.shape[1]
    most = np.where(np.isfinite(readings), np.abs(readings), -1.0).max(axis=1)
    sound: Truths = np.isfinite(starts) & np.isfinite(increments) & np.isfinite(last)
    sound &= (most >= 0) & (scaled(most, signal.unit.factor) < TOO_FAR)
    return sound & ~np.isneginf(readings).any(axis=1)


def _same_directions(rows: Places, starts: Numbers, increments: Numbers) -> Iterator[Places]:
    """Groups of messages whose beams have the same directions."""
    while len(rows):
        same = (starts[rows] == starts[rows[0]]) & (increments[rows] == increments[rows[0]])
        yield rows[same]
        rows = rows[~same]


def _least(signal: Signal, ranges: Numbers, angles: Numbers) -> Numbers:
    """The least distance from the outline in each row of ranges, which are in metres."""
    ranges = np.where(np.isfinite(ranges), ranges, np.inf)
    first = ranges.argmin(axis=1)
    rows = np.arange(len(ranges))
    least = distances(places(ranges[rows, first], angles[first], signal.sensor), signal.footprint)
    corners = np.array(signal.footprint) - np.array(signal.sensor[:2])
    reach = float(np.hypot(*corners.T).max()) + SLACK
    row, beam = np.nonzero(ranges <= (least + reach)[:, None])
    ends = places(ranges[row, beam], angles[beam], signal.sensor)
    np.minimum.at(least, row, distances(ends, signal.footprint))
    return least
