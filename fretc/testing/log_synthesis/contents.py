"""Field contents of a signal: a few candidates, each with the value that an audit reads.

No equations are solved: comparisons change only at their constants, so the constants and numbers
between and beyond them are tried, and the code that audits logs evaluates them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

import numpy as np

from fretc.logs.signals.enum_values import enum_index
from fretc.logs.signals.signals import clearance, sample
from fretc.testing.log_synthesis.messages import Content, SignalField, message
from fretish import expressions as e
from fretish.bindings.declarations import Reading, Reduce, Signal
from fretish.classes.frozen import dataclass
from fretish.units import unit

_MOST_NUMBERS = 4
"""Maximum number of constants of a comparison whose sums and differences are tried, too."""
_FARTHEST = 99.0
"""Range of a lidar beam in metres."""


@dataclass(frozen=True, slots=True)
class FieldContent:
    """A content of a signal's field."""

    content: Content | None
    """The content; None: no message is sent."""
    value: float
    """Value that the audit reads, as `sample` and `word` have it; NaN: unknown."""
    nominal: Fraction | str | None
    """The number in base units, or the enumeration value, that it represents."""


def choices(
    signal: Signal, field: SignalField, read_by: Iterable[e.Expression], wished: Iterable[object]
) -> tuple[FieldContent, ...]:
    """Candidates for a signal in order: preferred values, constants of comparisons, no message.

    Args:
        signal: signal with its unit and its reduction.
        field: field of the signal.
        read_by: expressions that name the signal.
        wished: preferred enumeration values, truth values, and numbers in the signal's unit; None:
            unknown.
    """
    values = dict.fromkeys(_nominal(signal, each) for each in wished if each is not None)
    if signal.values:
        values |= dict.fromkeys(signal.values)
    else:
        values |= dict.fromkeys(_points(signal.name, read_by))
    made = [each for nominal in values for each in _made(signal, field, nominal)]
    return (*made, *_unknown(signal, field))


def _nominal(signal: Signal, value: object) -> Fraction | str:
    if isinstance(value, str):
        return value
    exact = Fraction(str(value)) if isinstance(value, float) else Fraction(int(str(int(value))))  # type: ignore[call-overload]
    return exact * signal.unit.factor


def _points(name: str, read_by: Iterable[e.Expression]) -> list[Fraction]:
    """Constants at which a comparison may change, with numbers between and beyond them."""
    points = {Fraction(0), Fraction(1)}
    for expression in read_by:
        for part in e.parts(expression):
            if isinstance(part, e.Comparison) and any(n.id == name for n in e.names(part)):
                points |= set(_sums([*_constants(part)][:_MOST_NUMBERS]))
    ordered = sorted(points)
    between = [(low + high) / 2 for low, high in pairwise(ordered)]
    reach = max(abs(ordered[0]), abs(ordered[-1]), Fraction(1))
    return [*ordered, *between, ordered[0] - reach, ordered[-1] + reach]


def _constants(part: e.Expression) -> Iterator[Fraction]:
    for each in e.parts(part):
        if isinstance(each, e.Number):
            yield Fraction(each.digits)
        elif isinstance(each, e.Quantity) and (measure := unit(each.unit)) is not None:
            yield Fraction(each.digits) * measure.factor


def _sums(numbers: Sequence[Fraction]) -> Iterator[Fraction]:
    """All sums of the numbers, each with sign +, - or left out."""
    if not numbers:
        yield Fraction(0)
        return
    first, *others = numbers
    for rest in _sums(others):
        yield from (rest, rest + first, rest - first)


def _made(signal: Signal, field: SignalField, nominal: Fraction | str) -> Iterator[FieldContent]:
    for content in _contents(signal, field, nominal):
        if isinstance(content, str) or _fits(content, field):
            value = read(signal, field, content)
            if value is not None:
                yield FieldContent(content, value, nominal)


def _contents(signal: Signal, field: SignalField, nominal: Fraction | str) -> Iterator[Content]:
    if isinstance(nominal, str):
        index = signal.values.index(nominal) if nominal in signal.values else None
        if index is not None:
            yield signal.numbers[index] if signal.numbers else nominal
        return
    if signal.reduce is Reduce.OUTLINE:
        yield from ([beam] for beam in _beams(signal, float(nominal)))
        return
    number = nominal / signal.unit.factor
    exact: float = float(number) if field.has_nan else int(number)
    if field.has_nan or number.denominator == 1:
        yield [exact] if signal.path.each else exact


def _fits(content: float | Sequence[float], field: SignalField) -> bool:
    if field.has_nan or field.base == "string":
        return field.has_nan
    number = content[0] if isinstance(content, Sequence) else content
    if field.base == "bool":
        return number in (0, 1)
    limits = np.iinfo(
        {"octet": "uint8", "byte": "uint8", "char": "uint8"}.get(field.base, field.base)
    )
    return limits.min <= number <= limits.max


@lru_cache
def _beams(signal: Signal, gap: float) -> tuple[float, ...]:
    """The two ranges of a forward beam that ends about so far from the outline.

    The result is cached, because tests of a requirement need the same few distances.
    """
    first = (-math.inf,) if gap == 0 and signal.invalid.negative_infinity is Reading.NEAR else ()
    low, high = np.float32(0), np.float32(_FARTHEST)
    while np.nextafter(low, high) < high:
        middle = np.float32((low + high) / 2)
        if clearance(signal, np.array([middle], np.float32), 0.0, 0.0) < gap:
            low = middle
        else:
            high = middle
    return (*first, float(high), float(low))


def _unknown(signal: Signal, field: SignalField) -> Iterator[FieldContent]:
    """Content that makes the signal unknown: NaN, or no message."""
    if field.has_nan:
        content: Content = [math.nan] if signal.path.each else math.nan
        value = read(signal, field, content)
        if value is not None and math.isnan(value):
            yield FieldContent(content, value, None)
            return
    yield FieldContent(None, math.nan, None)


def read(signal: Signal, field: SignalField, content: Content) -> float | None:
    """Value that an audit reads from a message with the content; None if it finds none."""
    made = message(field.message, 0, {signal.path: content})
    value = (
        enum_index(signal, made)
        if signal.values
        else sample(signal, made, single=field.base == "float32")
    )
    return None if isinstance(value, str) else value
