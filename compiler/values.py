"""Numbers as a reader wants to see them: in the declared units, with digits that say something.

Evidence is in base units, whatever unit the bindings declare; people think in the declared ones.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from math import floor, isclose, isinf, isnan, log10
from typing import TypeVar

from compiler.evidence import Evidence, Result, Threshold, Violation
from compiler.surroundings import Samples
from fretish.declarations import Declarations, Signal
from fretish.units import base_name

_DIGITS = 4
"""Significant digits of a measured number, where nothing asks for more."""
_MOST_DIGITS = 17
"""With these, every 64-bit float is told from every other."""
_PLAIN = 10**15
"""Below it numbers have no exponent."""
_NAME = re.compile(r"[A-Za-z_]\w*")
Number = TypeVar("Number", float, float | None, float | str | None)


# Digits ----------------------------------------------------------------------------------------


def value(number: float | str | None, unit: str, beside: Sequence[float] = ()) -> str:
    """A measured number: `0.0318 m`, `unknown`; an infinite one as it is written, `+inf`.

    Args:
        number: in the unit; None: unknown.
        unit: as it is shown; empty for a plain number.
        beside: numbers that are shown exactly with it: it has as many digits as tell it from each,
            and on which side of each it lies.
    """
    if number is None or isinstance(number, str):
        return "unknown" if number is None else number
    if isnan(number) or isinf(number):
        return "unknown" if isnan(number) else "+inf" if number > 0 else "-inf"
    text = next(
        text
        for digits in range(_least_digits(number), _MOST_DIGITS + 1)
        for text in [_written(number, digits)]
        if digits == _MOST_DIGITS
        or all(_side(float(text), each) == _side(number, each) for each in beside)
    )
    return f"{text} {unit}".rstrip()


def exact(number: float, unit: str) -> str:
    """A bound, with all digits that it was written with: `0.05 m`, `1.23456 m`."""
    if isnan(number) or isinf(number):
        return value(number, unit)
    text = next(
        text
        for digits in range(1, _MOST_DIGITS + 1)
        for text in [_written(number, digits)]
        if digits == _MOST_DIGITS or isclose(float(text), number, rel_tol=1e-15)
    )
    return f"{text} {unit}".rstrip()


def _least_digits(number: float) -> int:
    """All digits before the point, as long as these are no more than a reader takes in."""
    size = floor(log10(abs(number))) + 1 if number else 1
    return max(_DIGITS, size) if size <= _DIGITS + 3 else _DIGITS


def _written(number: float, digits: int) -> str:
    text = f"{number:.{digits}g}"
    return f"{Decimal(text):f}" if "e+" in text and abs(number) < _PLAIN else text


def _side(number: float, bound: float) -> int:
    return (number > bound) - (number < bound)


# Units -----------------------------------------------------------------------------------------


def in_declared_units(evidence: Evidence, declared: Declarations | None) -> Evidence:
    """The same evidence with every number in the unit that the bindings declare for its signal.

    A signal that the bindings do not declare, or now in units of another dimension, stays in its
    base unit.
    """
    if declared is None:
        return evidence
    results = tuple(_result(result, declared.signals) for result in evidence.results)
    return replace(evidence, results=results)


def declared_unit(signal: str, base: str, declared: Mapping[str, Signal]) -> tuple[str, Fraction]:
    """The unit in which a signal is shown, and how many base units it has.

    Args:
        signal: its name.
        base: the base unit that its numbers are in.
        declared: the signals of the bindings.
    """
    found = declared.get(signal)
    if found is None or base_name(found.unit.dimension) != base:
        return base, Fraction(1)
    return "" if found.unit_name == "1" else found.unit_name, found.unit.factor


def scaled(number: Number, factor: Fraction) -> Number:
    """A number of base units as one of units that have so many of them, rounded once."""
    if not isinstance(number, float | int) or factor == 1 or isnan(number) or isinf(number):
        return number
    return float(Fraction(number) / factor)


def _result(result: Result, declared: Mapping[str, Signal]) -> Result:
    units = {name: declared_unit(name, base, declared) for name, base in result.units.items()}
    return replace(
        result,
        units={name: unit for name, (unit, _) in units.items()},
        violations=tuple(_violation(each, units) for each in result.violations),
        thresholds=tuple(_threshold(each, declared) for each in result.thresholds),
    )


_Units = Mapping[str, tuple[str, Fraction]]
_ONE = ("", Fraction(1))


def _violation(violation: Violation, units: _Units) -> Violation:
    def own(name: str) -> Fraction:
        return units.get(name, _ONE)[1]

    window = violation.window
    return replace(
        violation,
        values={name: scaled(number, own(name)) for name, number in violation.values.items()},
        window=window
        and replace(
            window, samples={name: _samples(s, own(name)) for name, s in window.samples.items()}
        ),
    )


def _samples(samples: Samples, factor: Fraction) -> Samples:
    if factor == 1:
        return samples
    return replace(samples, values=tuple(scaled(number, factor) for number in samples.values))


def _threshold(threshold: Threshold, declared: Mapping[str, Signal]) -> Threshold:
    """In the unit of its signals, where they have the same one."""
    found = {
        declared_unit(name, threshold.unit, declared)
        for name in _NAME.findall(threshold.signal)
        if name in declared and base_name(declared[name].unit.dimension) == threshold.unit
    }
    if len(found) != 1:
        return threshold
    ((unit, factor),) = found
    return replace(
        threshold,
        unit=unit,
        bound=scaled(threshold.bound, factor),
        least=scaled(threshold.least, factor),
        greatest=scaled(threshold.greatest, factor),
        margin=scaled(threshold.margin, factor),
    )
