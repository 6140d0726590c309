"""Format numbers and times for a reader: in declared units, with significant digits only.

Audits compute in base units; readers expect the units that the bindings declare.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from decimal import Decimal
from fractions import Fraction
from math import copysign, floor, inf, isclose, isfinite, isnan, log10
from sys import float_info
from typing import TypeVar

from fretish.bindings.declarations import MeasuredSignal
from fretish.units import base_name

_DIGITS = 3
"""Default number of significant digits of a measured number."""
_WHOLE = 7
"""Numbers with at most this many digits before the point are not rounded to fewer."""
_MOST_DIGITS = 17
"""Digits that distinguish any two 64-bit floats."""
_LARGEST = Fraction(float_info.max)
_PLAIN = 10**15
"""Smaller numbers are written without an exponent."""
_NAME = re.compile(r"[A-Za-z_]\w*")
Number = TypeVar("Number", float, float | None, float | str | None)


# Digits ----------------------------------------------------------------------------------------


def value(number: float | str | None, unit: str, bounds: Sequence[float] = ()) -> str:
    """A measured number as text: `0.0318 m`, `unknown`, `+inf`.

    Args:
        number: in `unit`; None: unknown; a text is returned unchanged.
        unit: the unit as displayed; empty for a plain number.
        bounds: numbers that are displayed exactly beside it. The text has enough digits to show
            whether the number is below, equal to or above each of them.
    """
    if number is None or isinstance(number, str):
        return "unknown" if number is None else number
    if not isfinite(number):
        return "unknown" if isnan(number) else "+inf" if number > 0 else "-inf"
    text = next(
        text
        for digits in range(_least_digits(number), _MOST_DIGITS + 1)
        for text in [_decimal(number, digits)]
        if digits == _MOST_DIGITS
        or (
            isfinite(float(text))
            and all(_side(float(text), bound) == _side(number, bound) for bound in bounds)
        )
    )
    return f"{text} {unit}".rstrip()


def exact(number: float, unit: str) -> str:
    """A bound with all digits of its source: `0.05 m`, `1.23456 m`."""
    if not isfinite(number):
        return value(number, unit)
    text = next(
        text
        for digits in range(1, _MOST_DIGITS + 1)
        for text in [_decimal(number, digits)]
        if digits == _MOST_DIGITS or isclose(float(text), number, rel_tol=1e-15)
    )
    return f"{text} {unit}".rstrip()


def margin(distance: float, unit: str, bound: float) -> str:
    """A distance to a bound, with the same number of decimals as a value near the bound.

    The difference of two nearly equal numbers has fewer significant digits than they have. A
    distance that is not 0 is never displayed as 0.
    """
    finite = distance and bound and isfinite(distance) and isfinite(bound)
    lost = floor(log10(abs(bound))) - floor(log10(distance)) if finite else 0
    meant = float(_decimal(distance, max(1, _DIGITS - lost))) if lost > 0 else distance
    return value(meant, unit, [0.0])


def _least_digits(number: float) -> int:
    """All digits before the point, up to `_WHOLE`; at least `_DIGITS`."""
    size = floor(log10(abs(number))) + 1 if number else 1
    return max(_DIGITS, size) if size <= _WHOLE else _DIGITS


def _decimal(number: float, digits: int) -> str:
    text = f"{number:.{digits}g}"
    return f"{Decimal(text):f}" if "e+" in text and abs(number) < _PLAIN else text


def _side(number: float, bound: float) -> int:
    return (number > bound) - (number < bound)


# Times ----------------------------------------------------------------------------------------


def count_of(count: int, noun: str) -> str:
    """`1 run`, `1,024 runs`."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def decimal(number: float, thousands: str = "") -> str:
    """At most three decimals, and no zeros at the end: `39.8`, `0.001`, `2`.

    Args:
        number: any number.
        thousands: the separator between groups of three digits.
    """
    if abs(number) >= 10**7:
        return f"{number:.6g}"
    text = f"{number:,.3f}".rstrip("0").rstrip(".").replace(",", thousands)
    return "0" if text == "-0" else text


def seconds(number: float) -> str:
    """A time from the first tick of a run, to the millisecond: `39.8 s`."""
    return f"{decimal(number)} s"


def duration(number: float, bounds: Sequence[float] = ()) -> str:
    """A measured duration: `304 ms`, `39.8 s`, `0 s`; rounded as by `value`.

    Args:
        number: seconds.
        bounds: limits in seconds that are displayed exactly beside it, as in `value`.
    """
    unit, places = _time_unit(number)
    return value(_moved(number, places), unit, [_moved(bound, places) for bound in bounds])


def exact_duration(number: float) -> str:
    """A time limit in seconds, with all digits of its source: `300 ms`, `1.5 s`."""
    unit, places = _time_unit(number)
    return exact(_moved(number, places), unit)


def _time_unit(number: float) -> tuple[str, int]:
    """The largest unit in which the rounded number is at least 1, and its decimal shift."""
    size = abs(number) or 1.0
    units = (("s", 0), ("ms", 3), ("us", 6), ("ns", 9))
    return next((unit for unit in units if size >= 0.9995 * 10.0 ** -unit[1]), units[-1])


def _moved(number: float, places: int) -> float:
    """The number times `10**places`, computed on its shortest text: 0.3 s are exactly 300 ms."""
    return float(Decimal(repr(float(number))).scaleb(places))


def instant(ns: int | None) -> str:
    """Nanoseconds since 1970 as `2023-11-14 22:13:20.041 UTC`."""
    if ns is None:
        return "not known"
    whole_seconds, rest = divmod(ns, 10**9)
    try:
        moment = datetime.fromtimestamp(whole_seconds, UTC)
    except (OverflowError, ValueError, OSError):
        return f"{ns} ns"
    return f"{moment:%Y-%m-%d %H:%M:%S}.{rest // 10**6:03d} UTC"


# Units ----------------------------------------------------------------------------------------


def declared_unit(
    signal: str, base: str, declared: Mapping[str, MeasuredSignal]
) -> tuple[str, Fraction]:
    """The unit in which a signal is displayed, and its size in base units.

    Args:
        signal: the name of the signal.
        base: the base unit of its numbers.
        declared: the signals of the bindings.
    """
    declaration = declared.get(signal)
    if declaration is None or base_name(declaration.unit.dimension) != base:
        return base, Fraction(1)
    return "" if declaration.unit_name == "1" else declaration.unit_name, declaration.unit.factor


def shared_unit(
    term: str, base: str, declared: Mapping[str, MeasuredSignal]
) -> tuple[str, Fraction]:
    """The unit in which a term is displayed: the common unit of its signals, else the base unit.

    Args:
        term: the text of the term, such as `abs(vx)`.
        base: the base unit of its numbers.
        declared: the signals of the bindings.
    """
    candidates = {
        declared_unit(name, base, declared)
        for name in _NAME.findall(term)
        if name in declared and base_name(declared[name].unit.dimension) == base
    }
    return candidates.pop() if len(candidates) == 1 else (base, Fraction(1))


def scaled(number: Number, factor: Fraction) -> Number:
    """A number in base units, converted to a unit of `factor` base units, and rounded once.

    A result outside the range of 64-bit floats is infinite.
    """
    if not isinstance(number, float | int) or factor == 1 or not isfinite(number):
        return number
    exactly = Fraction(number) / factor
    return float(exactly) if abs(exactly) <= _LARGEST else copysign(inf, number)
