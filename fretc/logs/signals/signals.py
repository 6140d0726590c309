"""The number of a signal in a decoded message.

Numbers are in the unit of the field, clearances in metres; NaN is unknown. An element that is not a
measurement (NaN, an infinity, a number outside of `valid`) never counts as a number: `Invalid`
states its meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from math import isfinite
from numbers import Real
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.measures import ExpressionError, NameValues
from fretc.logs.signals.outline import blind_share, distances, places
from fretc.logs.signals.propositions import TRUE, truth
from fretc.logs.signals.samples import EXACT, WHOLE, Values, scaled, widest
from fretc.logs.signals.thresholds import thresholds
from fretish import expressions as e
from fretish.bindings import amounts
from fretish.bindings.declarations import (
    Declarations,
    GoalStatus,
    Path,
    Proposition,
    Reading,
    Reduce,
    Signal,
)
from fretish.diagnostics.diagnostic import Diagnostic, did_you_mean
from fretish.diagnostics.messages import diagnostic
from monitors.goals import goal_status

RANGE_MIN = "range_min"
"""The field of a range sensor's messages with the least distance that it can measure."""


class FieldError(ValueError):
    """The message does not hold the number that the signal reads.

    The text names the missing field; `fix` describes the existing ones.
    """

    def __init__(self, message: str, fix: str | None = None) -> None:
        super().__init__(message)
        self.fix = fix


class UnstatedError(Exception):
    """The message type has the number that the signal reads, but the message leaves it out."""


class Sparse:
    """A decoded message that may leave out its fields: in JSON, or in Protobuf."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the fields that it has, or may have."""
        raise NotImplementedError

    def field(self, name: str) -> object:
        """The value of a field.

        Raises:
            UnstatedError: the field is left out, or stated as null.
            KeyError: there is no such field.
        """
        raise NotImplementedError


def sample(signal: Signal, message: object, *, single: bool = False) -> float:
    """The signal's value in one message.

    Elements are distinguished first: NaN, +inf, -inf, a finite number for which `valid` is not
    true, and a valid number. `signal.invalid` then says for each of the first four: it is
    dropped; it is far (+inf); it is near (-inf, and for `outline` a clearance of 0); or it makes
    the whole sample unknown. `valid` is read in the unit of the field. Beside 32-bit floats its
    numbers are rounded to 32 bits too, so that `x <= 0.3` keeps a 0.3.

    `outline` takes each element for a beam, as sensor_msgs/LaserScan defines them, and gives the
    least distance from `signal.footprint` to their end points. A valid beam that ends inside of
    the footprint has a clearance of 0: whether it met the robot itself cannot be known.

    Args:
        signal: what to read, and how.
        message: an object with the message's fields as attributes, arrays as sequences.
        single: whether the field was recorded as 32-bit floats.

    Returns:
        Times `signal.scale` it is in base units; an `int` where a whole number of 64 bits is
        beyond those that a 64-bit float holds. NaN, unknown, where nothing was measured: an index
        past the end, an empty array, an element that is unknown, nothing left after the drops, a
        field that a `Sparse` message leaves out.

    Raises:
        FieldError: the message has no such field, or something else than numbers is in it.
    """
    if signal.goals is not None:
        return goal_number(signal.goals, message)
    try:
        value = _field(signal, message)
        if isinstance(value, float | int) and signal.valid is None and isfinite(value):
            return value  # a fast path for most signals
        values = np.array([value], _kind(value)) if isinstance(value, float | int) else value
        with np.errstate(all="ignore"):  # too large numbers become infinite, and a NaN may signal
            return _sample(signal, message, values.astype(np.float32) if single else values)
    except UnstatedError:
        return float("nan")


def goal_number(goals: GoalStatus, message: object) -> float:
    """The status of goals in a message: a place in its values, or a truth value; NaN: unknown.

    Raises:
        FieldError: the message has no statuses of goals.
    """
    try:
        number = goal_status(message, str(goals.choice), goals.statuses, _part)
    except UnstatedError:
        return float("nan")
    except (AttributeError, KeyError, TypeError, ValueError):
        raise FieldError("its messages list no goals with their statuses") from None
    return float("nan") if number is None else float(number)


def _part(holder: Any, name: str) -> Any:
    if isinstance(holder, Sparse):
        return holder.field(name)
    return holder[name] if isinstance(holder, Mapping) else getattr(holder, name)


def _kind(value: float) -> np.dtype[Any]:
    return EXACT if isinstance(value, int) else np.dtype(np.float64)


def _sample(signal: Signal, message: object, values: Values) -> float:
    valid = _valid(signal, message, values)
    readings = _readings(signal, unrounded(signal, values), valid)
    if readings is None or np.isnan(readings).all():
        return float("nan")
    if signal.reduce is Reduce.OUTLINE:
        start, step = _sibling(message, "angle_min"), _sibling(message, "angle_increment")
        return clearance(signal, readings, start, step)
    measured = readings[~np.isnan(readings)]
    return _reduced(signal.reduce, measured)


def nearest(signal: Signal, message: object) -> float | None:
    """The least distance that the sensor can report, as the message itself states it.

    Returns:
        `range_min` in metres, for a signal that is the nearest of many readings; None for
        others, and where the message does not state it.
    """
    if signal.memory is not None or signal.reduce not in (Reduce.MIN, Reduce.OUTLINE):
        return None
    range_min = optional_field(message, RANGE_MIN)
    if not isinstance(range_min, Real) or not np.isfinite(float(range_min)):
        return None
    return scaled(float(range_min), signal.unit.factor)


# Elements


def _field(signal: Signal, message: object) -> float | Values:
    """A number, or the chosen elements of an array, shape (n,), in the unit of the field."""
    path = signal.path
    value = field_of(path, message)
    name = ".".join(path.fields)
    if not path.each and path.index is None:
        return _number(value, name)
    if path.index is not None and isinstance(value, list):
        value = value[path.index : path.index + 1]  # its other elements may be of any kind
        return _array(value, name)
    values = _array(value, name)
    if path.index is None:
        return values
    return values[path.index : path.index + 1]


def field_of(path: Path, message: object) -> object:
    """The value of a field of a message; for an array all of it.

    Raises:
        UnstatedError: the message leaves it out.
        FieldError: it has no such field.
    """
    value = message
    for position, name in enumerate(path.fields):
        value = _attribute(value, name, ".".join(path.fields[:position]))
    return value


def _attribute(value: object, name: str, parent: str) -> object:
    if isinstance(value, Sparse):
        with suppress(KeyError):
            return value.field(name)
    names = fields(value)
    if name in names:
        return getattr(value, name)
    where = f"`{parent}`" if parent else "the message"
    fix = did_you_mean(name, names, f"it has {', '.join(names)}") if names else None
    raise FieldError(f"{where} has no field `{name}`", fix)


def fields(message: object) -> tuple[str, ...]:
    """The names of a decoded message's fields, in their order; empty: it is not a message."""
    if isinstance(message, Sparse):
        return message.names
    slots = getattr(type(message), "__slots__", None)
    if slots:
        return tuple(slots)
    return tuple(getattr(message, "__dict__", ()))


def optional_field(message: object, name: str) -> object | None:
    """A field of a decoded message; None: it is unknown or left out."""
    if not isinstance(message, Sparse):
        return getattr(message, name, None)
    try:
        return message.field(name)
    except (KeyError, UnstatedError):
        return None


def _number(value: object, name: str) -> float:
    if isinstance(value, float | int | Real | np.bool_):  # the frequent ones first
        return _exact(value)
    inner = fields(value)
    if inner:
        raise FieldError(f"`{name}` is no number", f"it has {', '.join(inner)}")
    if isinstance(value, list | tuple | bytes | np.ndarray):
        raise FieldError(
            f"`{name}` is an array", f"write `{name}[0]`, or `{name}[:]` with `reduce`"
        )
    raise FieldError(f"`{name}` is no number")


def _exact(value: float | Real | np.bool_) -> float:
    """The number as a float; a whole number of 64 bits beyond 64-bit floats stays an integer."""
    if isinstance(value, int | np.integer):
        integer = int(value)
        if WHOLE <= integer < 2**64 or -(2**63) <= integer <= -WHOLE:
            return integer
    return float(value)


def _array(value: object, name: str) -> Values:
    if isinstance(value, bytes | bytearray):
        return np.frombuffer(value, np.uint8).astype(np.float64)
    if isinstance(value, str) or not isinstance(value, list | tuple | np.ndarray):
        raise FieldError(f"`{name}` is no array", "leave out the index")
    try:
        values = np.asarray(value)
    except (TypeError, ValueError):
        raise FieldError(f"`{name}` is no array of numbers") from None
    if values.ndim == 1 and values.dtype.kind in "biuf":
        large = np.isfinite(values) & (np.abs(values) >= WHOLE)
        if isinstance(value, np.ndarray) or values.dtype.kind != "f" or not large.any():
            return widest(values)
    elements = [_element(item, name) for item in value]
    exact = any(isinstance(element, int) for element in elements)
    return np.array(elements, EXACT if exact else np.float64)


def _element(value: object, name: str) -> float:
    """One element of an array whose elements are not all numbers of one type."""
    if value is None:
        raise UnstatedError
    if not isinstance(value, Real | np.bool_):
        raise FieldError(f"`{name}` is no array of numbers")
    return _exact(value)


# The meaning of elements


def _valid(signal: Signal, message: object, values: Values) -> NDArray[np.bool_]:
    """The elements that are measurements."""
    finite = np.isfinite(values)
    if signal.valid is None:
        return finite
    names = {name.id for name in e.names(signal.valid)} - {"x"}
    siblings = {name: np.array([_sibling(message, name)]) for name in names}
    scope = NameValues(len(values), {"x": values, **siblings}, signal.field_unit)
    try:
        accepted: NDArray[np.bool_] = truth(signal.valid, scope) == TRUE
    except ExpressionError as error:
        raise FieldError(f"`valid` cannot be evaluated: {error}") from None
    return finite & accepted


def _sibling(message: object, name: str) -> float:
    return float(_number(_attribute(message, name, ""), name))


def unrounded(signal: Signal, values: Values) -> Values:
    """The elements as 64-bit floats; unchanged if these are inexact and one element is chosen."""
    keeps = is_chosen(signal) and values.dtype == EXACT
    return values if keeps else values.astype(np.float64)


def is_chosen(signal: Signal) -> bool:
    """Whether the samples of the signal are numbers of the log, not computed ones."""
    return not signal.values and signal.reduce not in (Reduce.MEAN, Reduce.OUTLINE)


def _readings(signal: Signal, values: Values, valid: NDArray[np.bool_]) -> Values | None:
    """The elements with infinities for far and near; NaN where one is dropped.

    None when an element makes the whole sample unknown.
    """
    invalid = signal.invalid
    readings = values.copy()
    for chosen, reading in (
        (np.isnan(values), invalid.nan),
        (np.isposinf(values), invalid.positive_infinity),
        (np.isneginf(values), invalid.negative_infinity),
        (np.isfinite(values) & ~valid, invalid.other),
    ):
        if not chosen.any():
            continue
        match reading:
            case Reading.UNKNOWN:
                return None
            case Reading.DROP:
                readings[chosen] = np.nan
            case Reading.FAR:
                readings[chosen] = np.inf
            case Reading.NEAR:
                readings[chosen] = -np.inf
            case _:
                assert_never(reading)
    return readings


def _reduced(reduce: Reduce | None, readings: Values) -> float:
    match reduce:
        case None:
            return _python(readings[0])
        case Reduce.MIN:
            return _python(readings.min()) + 0  # never -0.0: which zero is first depends on NumPy
        case Reduce.MAX:
            return _python(readings.max()) + 0
        case Reduce.MEAN:
            return mean(readings)
        case _:
            raise AssertionError(f"{reduce} takes more than the numbers")


def mean(readings: Values) -> float:
    """The mean of at least one number; finite for finite numbers, even if their sum is not."""
    with np.errstate(over="ignore", invalid="ignore"):
        average = float(readings.mean())
        return average if isfinite(average) else float((readings / len(readings)).sum())


def _python(value: np.floating[Any]) -> float:
    number = float(value)
    return int(value) if value.dtype == EXACT and WHOLE <= abs(number) < np.inf else number


def clearance(signal: Signal, readings: Values, start: float, step: float) -> float:
    """Metres from the footprint to the nearest end of a beam; inf where all are far.

    Args:
        signal: a signal with `outline`.
        readings: the reading of each beam in turn; NaN: it is dropped.
        start: radians, the angle of the first beam.
        step: radians from a beam to the next.
    """
    if np.isneginf(readings).any():
        return 0.0
    beams = np.isfinite(readings)
    if not beams.any():
        return float("inf")
    angles = start + step * np.arange(len(readings), dtype=float)
    ranges = scaled(readings[beams].astype(np.float64), signal.unit.factor)
    ends = places(ranges, angles[beams], signal.sensor)
    return float(distances(ends, signal.footprint).min())


# Bounds where the sensor is blind


def blind_zones(
    proposition: Proposition, declarations: Declarations, nearest: Mapping[str, float]
) -> tuple[Diagnostic, ...]:
    """F311 for each bound of the proposition that lies nearer than its sensor can measure.

    A bound is a number that a signal is compared with by `<`, `<=`, `>` or `>=`; where nothing
    beyond it can be measured, the comparison says the same for ever. Signals for which readings
    outside of `valid` count as near are left out.

    Args:
        proposition: with an expression over signals.
        declarations: what it was declared with.
        nearest: for each signal the least distance that its sensor reports, in metres, as
            `Recording.nearest` has it.
    """
    warnings = []
    for threshold in thresholds(proposition, declarations.signals):
        if not isinstance(threshold.term, e.Name):
            continue
        signal, limit = declarations.signals[threshold.term.id], nearest.get(threshold.term.id)
        if limit is None or signal.invalid.other is Reading.NEAR:
            continue
        share = _blind(signal, threshold.bound, limit, threshold.operator)
        if share > 0:
            warnings.append(_blind_zone(proposition, signal, threshold.bound, limit, share))
    return tuple(warnings)


def _blind(signal: Signal, bound: float, limit: float, op: str) -> float:
    """The share of the circle in which the bound cannot be reached; for `min` 0 or 1."""
    if signal.reduce is Reduce.OUTLINE:
        return _blind_share(bound, limit, signal.footprint, signal.sensor)
    return float(bound <= limit if op in ("<", ">=") else bound < limit)


_blind_share = lru_cache(256)(blind_share)
"""A cache: for a robot and a sensor it is equal in every log."""


def _blind_zone(
    proposition: Proposition, signal: Signal, bound: float, limit: float, share: float
) -> Diagnostic:
    shown_bound, shown_limit = (amounts.scaled(each, signal.unit.factor) for each in (bound, limit))
    unit = "" if signal.unit_name == "1" else signal.unit_name
    where = "" if share == 1 else f" in {round(share * 360)} of 360 degrees"
    return diagnostic(
        "blind_zone",
        proposition.span,
        proposition=proposition.name,
        signal=signal.name,
        bound=amounts.exact(shown_bound, unit),
        topic=signal.path.topic,
        limit=amounts.value(shown_limit, unit, [shown_bound]),
        where=where,
    )
