"""Numbers and times for a reader: in declared units, with the digits that mean something.

Audits count in base units, whatever unit the bindings declare; people think in the declared ones.
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

from fretish.bindings.declarations import Signal
from fretish.units import base_name

_DIGITS = 3
"""Significant digits of a measured number, where nothing asks for more."""
_WHOLE = 7
"""So many digits before the point are shown all."""
_MOST_DIGITS = 17
"""So many digits distinguish all 64-bit floats."""
_LARGEST = Fraction(float_info.max)
_PLAIN = 10**15
"""Below it numbers have no exponent."""
_NAME = re.compile(r"[A-Za-z_]\w*")
Number = TypeVar("Number", float, float | None, float | str | None)


# Digits ----------------------------------------------------------------------------------------


def value(number: float | str | None, unit: str, bounds: Sequence[float] = ()) -> str:
    """A measured number: `0.0318 m`, `unknown`; an infinite one as it is written, `+inf`.

    Args:
        number: in the unit; None: unknown.
        unit: as it is shown; empty for a plain number.
        bounds: numbers that appear exactly beside it: it gets as many digits as show whether it
            equals each of them, and on which side of each it lies.
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
            and all(_side(float(text), each) == _side(number, each) for each in bounds)
        )
    )
    return f"{text} {unit}".rstrip()


def exact(number: float, unit: str) -> str:
    """A bound, with all digits that it was written with: `0.05 m`, `1.23456 m`."""
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
    """A distance to a bound: its digits end where those of a value beside the bound would.

    The difference of two near numbers has as many decimals as they have, and fewer digits. A
    distance never looks like none.
    """
    finite = distance and bound and isfinite(distance) and isfinite(bound)
    lost = floor(log10(abs(bound))) - floor(log10(distance)) if finite else 0
    meant = float(_decimal(distance, max(1, _DIGITS - lost))) if lost > 0 else distance
    return value(meant, unit, [0.0])


def _least_digits(number: float) -> int:
    """All digits before the point, as long as these are no more than a reader takes in."""
    size = floor(log10(abs(number))) + 1 if number else 1
    return max(_DIGITS, size) if size <= _WHOLE else _DIGITS


def _decimal(number: float, digits: int) -> str:
    text = f"{number:.{digits}g}"
    return f"{Decimal(text):f}" if "e+" in text and abs(number) < _PLAIN else text


def _side(number: float, bound: float) -> int:
    return (number > bound) - (number < bound)


# Times ----------------------------------------------------------------------------------------


def decimal(number: float, thousands: str = "") -> str:
    """At most three decimals, and no zeros at the end: `39.8`, `0.001`, `2`.

    Args:
        number: any.
        thousands: what stands between groups of three digits.
    """
    if abs(number) >= 10**7:
        return f"{number:.6g}"
    text = f"{number:,.3f}".rstrip("0").rstrip(".").replace(",", thousands)
    return "0" if text == "-0" else text


def seconds(number: float) -> str:
    """A time from the first tick of a run, to the millisecond: `39.8 s`."""
    return f"{decimal(number)} s"


def duration(number: float, bounds: Sequence[float] = ()) -> str:
    """How long something took: `304 ms`, `39.8 s`, `0 s`; with the digits of a measured number.

    Args:
        number: seconds.
        bounds: seconds that appear exactly beside it, as of `value`.
    """
    unit, places = _time_unit(number)
    return value(_moved(number, places), unit, [_moved(bound, places) for bound in bounds])


def exact_duration(number: float) -> str:
    """A limit of time in seconds, with all digits that it was written with: `300 ms`, `1.5 s`."""
    unit, places = _time_unit(number)
    return exact(_moved(number, places), unit)


def _time_unit(number: float) -> tuple[str, int]:
    """Seconds, or the unit in which it is one at least, also when it is rounded; 0 in seconds."""
    size = abs(number) or 1.0
    units = (("s", 0), ("ms", 3), ("us", 6), ("ns", 9))
    return next((each for each in units if size >= 0.9995 * 10.0 ** -each[1]), units[-1])


def _moved(number: float, places: int) -> float:
    """The number with its point moved: of its shortest text, so that 0.3 s are 300 ms."""
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


def declared_unit(signal: str, base: str, declared: Mapping[str, Signal]) -> tuple[str, Fraction]:
    """The unit in which a signal is shown, and how many base units it has.

    Args:
        signal: its name.
        base: the base unit that its numbers are in.
        declared: the signals of the bindings.
    """
    declaration = declared.get(signal)
    if declaration is None or base_name(declaration.unit.dimension) != base:
        return base, Fraction(1)
    return "" if declaration.unit_name == "1" else declaration.unit_name, declaration.unit.factor


def shared_unit(term: str, base: str, declared: Mapping[str, Signal]) -> tuple[str, Fraction]:
    """The unit in which a term is shown: that of its signals, where they have the same one.

    Args:
        term: as it is written, such as `abs(vx)`.
        base: the base unit that its numbers are in.
        declared: the signals of the bindings.
    """
    candidates = {
        declared_unit(name, base, declared)
        for name in _NAME.findall(term)
        if name in declared and base_name(declared[name].unit.dimension) == base
    }
    return candidates.pop() if len(candidates) == 1 else (base, Fraction(1))


def scaled(number: Number, factor: Fraction) -> Number:
    """A number of base units as one of units that have so many of them, rounded once.

    One beyond the range of 64-bit floats is infinite.
    """
    if not isinstance(number, float | int) or factor == 1 or not isfinite(number):
        return number
    exactly = Fraction(number) / factor
    return float(exactly) if abs(exactly) <= _LARGEST else copysign(inf, number)
