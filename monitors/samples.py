"""Read samples from messages as the bindings declare, and Kleene's three-valued logic.

`fretc.logs.signals` reads the same samples from a recording. Only a clearance is computed by other
library functions than in an audit, and may differ in the last digits. The text of this module is
copied into emitted nodes: it needs the standard library only.
"""

from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import cos, hypot, inf, isfinite, isnan, nan, sin
from typing import Any, NamedTuple

from monitors.kernel.readings import Reading, Single, exact, number
from monitors.kernel.verdicts import Truth

DROP, FAR, NEAR, UNKNOWN = "drop", "far", "near", "unknown"
"""How an element that is not a valid measurement is interpreted."""


class Policy(NamedTuple):
    """How a signal is read from a field of a message."""

    name: str
    topic: str
    fields: "tuple[str, ...]"
    place: "int | None" = None
    """The index of one element of an array."""
    each: bool = False
    """Whether `reduce` combines all elements of an array into one number."""
    reduce: str = ""
    """`min`, `max` or `outline`."""
    invalid: "tuple[str, str, str, str]" = (UNKNOWN,) * 4
    """How NaN, +inf, -inf and a finite number outside of `valid` are interpreted."""
    valid: "Callable[[Mapping[str, Reading]], Truth] | None" = None
    """Whether an element `x` is a valid measurement; also given the fields `beside`."""
    quick: "Callable[..., list[Reading]] | None" = None
    """The readings of a whole array of floats. Arguments: the array, a function for invalid
    elements, and the fields `beside`, none of which may be unknown."""
    beside: "tuple[str, ...]" = ()
    series: "Callable[[], Any] | None" = None
    """Makes the series of a signal with memory; None: its samples are its values."""
    max_age: "int | None" = None
    words: "tuple[str, ...]" = ()
    """The words of an enumerated signal; a sample is the index of its word."""
    numbers: "tuple[int, ...]" = ()
    """The numbers of the words in messages; empty: the field holds the words."""
    scale: str = "1"
    """The factor from the field's unit to metres, for `outline`."""
    footprint: "tuple[tuple[float, float], ...]" = ()
    sensor: "tuple[float, float, float]" = (0.0, 0.0, 0.0)
    read: "Callable[[Any], Reading] | None" = None
    """Function of a message that gives the sample; None: it is read from the field."""
    is_pose: bool = False
    """Whether it is read from transforms, not from a field: `BindingConfig.frames` has them."""


def field(message: Any, path: "Iterable[str]") -> Any:
    """The value of a field of a message.

    Raises:
        AttributeError: the message has no such field.
    """
    for name in path:
        message = getattr(message, name)
    return message


def sample(policy: Policy, message: Any, single: bool = False) -> Reading:
    """The sample of a signal in a message; None: unknown.

    Args:
        policy: how the signal is read.
        message: the message, with fields as attributes.
        single: whether the field has 32-bit floats.

    Raises:
        AttributeError: the message has no such field.
        TypeError: the field does not hold numbers.
    """
    if policy.read is not None:
        return policy.read(message)
    value = field(message, policy.fields)
    if policy.place is not None:
        if policy.place >= len(value):
            return None
        value = value[policy.place]
    if policy.words:
        return _place(policy, value)
    if policy.each and policy.quick and _is_floats(value):
        quick = _quick_sample(policy, policy.quick, message, value)
        if quick is not None:
            return Single(quick) if single and policy.reduce != "outline" else quick
    elements = _elements(policy, message, value if policy.each else (value,), single)
    if elements is None or all(element is None for element in elements):
        return None
    if policy.reduce == "outline":
        start, step = (_beside(message, name) for name in ("angle_min", "angle_increment"))
        if start is None or step is None:
            return None
        return _clearance(policy, enumerate(elements), float(start), float(step))
    measured = [element for element in elements if element is not None]
    chosen = max(measured) if policy.reduce == "max" else min(measured)
    return Single(chosen) if single else chosen


def _is_floats(values: Any) -> bool:
    if isinstance(values, array):
        return values.typecode in ("f", "d")
    return {*map(type, values)} == {float}


def _quick_sample(
    policy: Policy, quick: "Callable[..., list[Reading]]", message: Any, values: "Sequence[float]"
) -> "float | None":
    """The sample where one extreme element decides it; None: all elements must be looked at.

    It decides if it is a valid measurement, and no invalid element can be more extreme.
    """
    extreme = max(values, default=nan) if policy.reduce == "max" else min(values, default=nan)
    harmless = {DROP, NEAR} if policy.reduce == "max" else {DROP, FAR}
    nan_kind, *infinities, other = policy.invalid
    opposite = infinities[policy.reduce == "max"]
    if not isfinite(extreme) or not {nan_kind, opposite, other} <= harmless:
        return None
    row = [_beside(message, name) for name in policy.beside]
    if None in row or quick((extreme,), lambda x: None, *row) != [extreme]:
        return None
    if policy.reduce != "outline":
        return extreme
    start, step = (_beside(message, name) for name in ("angle_min", "angle_increment"))
    if start is None or step is None:
        return None
    nearest = (values.index(extreme), extreme)
    top, bottom = _ratio(policy)
    gap = _clearance(policy, (nearest,), float(start), float(step))
    limit = (gap + _reach(policy)) * bottom / top
    near = [(i, value) for i, value in enumerate(values) if value <= limit]
    readings = quick([value for _, value in near], lambda x: None, *row)
    places = [i for i, _ in near]
    return _clearance(policy, zip(places, readings), float(start), float(step))


def _place(policy: Policy, value: Any) -> Reading:
    keys: Sequence[Any] = policy.numbers if not isinstance(value, str) else policy.words
    if isinstance(value, str) and policy.numbers:
        return None
    return float(keys.index(value)) if value in keys else None


def _beside(message: Any, name: str) -> Reading:
    value = getattr(message, name)
    reading = number(int(value) if isinstance(value, bool) else value, name)
    return None if reading is None else float(reading)


def _elements(
    policy: Policy, message: Any, values: "Iterable[Any]", single: bool
) -> "list[Reading] | None":
    """The readings: infinities for far and near, None if dropped; None for the list if unknown."""
    row: dict[str, Reading] = {name: _beside(message, name) for name in policy.beside}
    if policy.quick and None not in row.values() and {*map(type, values)} <= {float}:
        try:
            return policy.quick(values, lambda x: _meant(policy, x), *row.values())
        except _UnknownSampleError:
            return None
    readings: list[Reading] = []
    for value in values:
        x = Single(value) if single else number(+value, policy.name)
        if x is not None and isfinite(x):
            row["x"] = x
            if policy.valid is None or policy.valid(row):
                readings.append(x)
                continue
        try:
            readings.append(_meant(policy, x))
        except _UnknownSampleError:
            return None
    return readings


class _UnknownSampleError(Exception):
    """An element makes the whole sample unknown."""


def _meant(policy: Policy, x: Reading) -> Reading:
    """The reading of an invalid element: an infinity for far or near, None if dropped."""
    finite = x is not None and isfinite(x)
    kind = 3 if finite else 0 if x is None or isnan(x) else 1 if x > 0 else 2
    meaning = policy.invalid[kind]
    if meaning == UNKNOWN:
        raise _UnknownSampleError
    return {DROP: None, FAR: inf, NEAR: -inf}[meaning]


def _clearance(
    policy: Policy, ranges: "Iterable[tuple[int, Reading]]", start: float, step: float
) -> float:
    """The distance in metres between the footprint and the nearest scan point.

    Args:
        policy: how the signal is read.
        ranges: the index of each beam, and its reading.
        start: the angle of beam 0, in radians.
        step: the angle between two beams, in radians.
    """
    x, y, yaw = policy.sensor
    top, bottom = _ratio(policy)
    reach, least, limit = _reach(policy), inf, inf
    for i, value in ranges:
        if value is None or value > limit or value == inf:
            continue
        if value == -inf:
            return 0.0
        length = value * top / bottom  # Inlined `in_base`: faster for each beam.
        angle = start + step * i + yaw
        gap = _gap(x + length * cos(angle), y + length * sin(angle), policy.footprint)
        if gap < least:
            least = gap
            limit = (least + reach) * bottom / top
    return least


def _ratio(policy: Policy) -> "tuple[float, float]":
    """The factor from the field's unit to metres: numerator and denominator."""
    top, bottom = exact(policy.scale).exact.as_integer_ratio()
    return float(top), float(bottom)


def _reach(policy: Policy) -> float:
    """The distance in metres from the sensor to the farthest corner.

    A beam that is longer than a gap and this together is not nearer than that gap.
    """
    x, y, _ = policy.sensor
    # 1 mm exceeds any rounding error.
    return max(hypot(a - x, b - y) for a, b in policy.footprint) + 1e-3


def _gap(x: float, y: float, corners: "Sequence[tuple[float, float]]") -> float:
    """The distance from a point to a polygon; 0 inside."""
    inside, least = False, inf
    for index, (x1, y1) in enumerate(corners):
        x2, y2 = corners[(index + 1) % len(corners)]
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) / (y2 - y1) * (x2 - x1):
            inside = not inside
        ax, ay = x2 - x1, y2 - y1
        part = ((x - x1) * ax + (y - y1) * ay) / ((ax * ax + ay * ay) or 1.0)
        part = min(1.0, max(0.0, part))
        least = min(least, hypot(x - x1 - part * ax, y - y1 - part * ay))
    return 0.0 if inside else least


# Kleene's three-valued logic ---------------------------------------------------------------------


def flag(reading: Reading) -> Truth:
    """A number as a truth value: 1 is true, 0 is false, any other is unknown."""
    return None if reading not in (0, 1) else reading == 1


def negation(truth: Truth) -> Truth:
    """Three-valued negation."""
    return None if truth is None else not truth


def every(*truths: Truth) -> Truth:
    """Three-valued conjunction."""
    return False if False in truths else None if None in truths else True


def some(*truths: Truth) -> Truth:
    """Three-valued disjunction."""
    return True if True in truths else None if None in truths else False


def same(left: Truth, right: Truth) -> Truth:
    """Three-valued equivalence."""
    return None if left is None or right is None else left is right
