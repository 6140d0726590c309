"""From a message to the number of a sample, as the bindings ask for it; and Kleene's logic.

It is what `fretc.logs.signals` does of a recording. A clearance alone is computed by other library
functions than an audit's and may differ from it in the last digits. The text of this module is
copied into emitted nodes: it needs the standard library only.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import cos, hypot, inf, isfinite, isinf, isnan, sin
from typing import Any, NamedTuple

from monitors.kernel.readings import Reading, Single, exact, number
from monitors.kernel.verdicts import Truth

DROP, FAR, NEAR, UNKNOWN = "drop", "far", "near", "unknown"
"""What an element that is no measurement means."""


class Policy(NamedTuple):
    """A signal: which field of a message, and which number that is."""

    name: str
    topic: str
    fields: tuple[str, ...]
    place: int | None = None
    """Of one element of an array."""
    each: bool = False
    """Whether all elements of an array count, of which `reduce` makes one number."""
    reduce: str = ""
    """`min`, `max` or `outline`."""
    invalid: tuple[str, str, str, str] = (UNKNOWN,) * 4
    """What NaN, +inf, -inf and a finite number mean for which `valid` is not true."""
    valid: Callable[[Mapping[str, Reading]], Truth] | None = None
    """Of an element, `x`, and of the fields `beside` it."""
    quick: Callable[..., list[Reading]] | None = None
    """The same of a whole array of Python's floats, with a function for those that are no
    measurement, and with the fields `beside` it, none of which is unknown."""
    beside: tuple[str, ...] = ()
    max_age: int | None = None
    words: tuple[str, ...] = ()
    """What a word may be: the number of a sample is the place of its word."""
    numbers: tuple[int, ...] = ()
    """By which numbers a message means the words; none: by the words."""
    scale: str = "1"
    """From the unit of the field to metres, for `outline`."""
    footprint: tuple[tuple[float, float], ...] = ()
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)


def field(message: Any, path: Iterable[str]) -> Any:
    """What a field of a message holds.

    Raises:
        AttributeError: there is none.
    """
    for name in path:
        message = getattr(message, name)
    return message


def sample(policy: Policy, message: Any, single: bool = False) -> Reading:
    """The number of a message; None: unknown.

    Args:
        policy: of the signal.
        message: with fields as attributes.
        single: whether the field is of 32-bit floats.

    Raises:
        AttributeError: the message has no such field.
        TypeError: something else than numbers is in it.
    """
    value = field(message, policy.fields)
    if policy.place is not None:
        if policy.place >= len(value):
            return None
        value = value[policy.place]
    if policy.words:
        return _place(policy, value)
    elements = _elements(policy, message, value if policy.each else (value,), single)
    if elements is None or all(element is None for element in elements):
        return None
    if policy.reduce == "outline":
        start, step = (_beside(message, name) for name in ("angle_min", "angle_increment"))
        if start is None or step is None:
            return None
        return _clearance(policy, elements, float(start), float(step))
    measured = [element for element in elements if element is not None]
    chosen = max(measured) if policy.reduce == "max" else min(measured)
    return Single(chosen) if single else chosen


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
    policy: Policy, message: Any, values: Iterable[Any], single: bool
) -> list[Reading] | None:
    """Infinities for far and near, None where one is dropped; no list: all is unknown."""
    row: dict[str, Reading] = {name: _beside(message, name) for name in policy.beside}
    if policy.quick and None not in row.values() and {*map(type, values)} <= {float}:
        try:
            return policy.quick(values, lambda x: _meant(policy, x), *row.values())
        except _UnknownSampleError:
            return None
    found: list[Reading] = []
    for value in values:
        x = Single(value) if single else number(+value, policy.name)
        if x is not None and isfinite(x):
            row["x"] = x
            if policy.valid is None or policy.valid(row):
                found.append(x)
                continue
        try:
            found.append(_meant(policy, x))
        except _UnknownSampleError:
            return None
    return found


class _UnknownSampleError(Exception):
    """An element makes all of the sample unknown."""


def _meant(policy: Policy, x: Reading) -> Reading:
    """An element that is no measurement: infinity for far and near, None where it is dropped."""
    finite = x is not None and isfinite(x)
    kind = 3 if finite else 0 if x is None or isnan(x) else 1 if x > 0 else 2
    meaning = policy.invalid[kind]
    if meaning == UNKNOWN:
        raise _UnknownSampleError
    return {DROP: None, FAR: inf, NEAR: -inf}[meaning]


def _clearance(policy: Policy, ranges: Sequence[Reading], start: float, step: float) -> float:
    """Metres from the footprint to the nearest end of a beam."""
    if -inf in ranges:
        return 0.0
    x, y, yaw = policy.sensor
    reach = max(hypot(a - x, b - y) for a, b in policy.footprint)
    top, bottom = (float(each) for each in exact(policy.scale).exact.as_integer_ratio())
    least = limit = inf
    for i, value in enumerate(ranges):
        if value is None or value > limit or isinf(value):
            continue
        length = value * top / bottom  # as `in_base`, without a call for each beam
        angle = start + step * i + yaw
        gap = _gap(x + length * cos(angle), y + length * sin(angle), policy.footprint)
        if gap < least:
            least = gap
            # What is farther out cannot be nearer; a millimetre is more than any rounding.
            limit = (least + reach + 1e-3) * bottom / top
    return least


def _gap(x: float, y: float, corners: Sequence[tuple[float, float]]) -> float:
    """From a point to a polygon; 0 within it."""
    inside, least = False, inf
    for place, (x1, y1) in enumerate(corners):
        x2, y2 = corners[(place + 1) % len(corners)]
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) / (y2 - y1) * (x2 - x1):
            inside = not inside
        ax, ay = x2 - x1, y2 - y1
        part = ((x - x1) * ax + (y - y1) * ay) / ((ax * ax + ay * ay) or 1.0)
        part = min(1.0, max(0.0, part))
        least = min(least, hypot(x - x1 - part * ax, y - y1 - part * ay))
    return 0.0 if inside else least


# Kleene's logic of what is read ------------------------------------------------------------------


def flag(reading: Reading) -> Truth:
    """A number as a truth: 1 is true, 0 is false, any other is unknown."""
    return None if reading not in (0, 1) else reading == 1


def negation(truth: Truth) -> Truth:
    """Not."""
    return None if truth is None else not truth


def every(*truths: Truth) -> Truth:
    """And."""
    return False if False in truths else None if None in truths else True


def some(*truths: Truth) -> Truth:
    """Or."""
    return True if True in truths else None if None in truths else False


def same(left: Truth, right: Truth) -> Truth:
    """If and only if."""
    return None if left is None or right is None else left is right
