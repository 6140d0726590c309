"""Results in the units that the bindings declare, for every output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isinf

from compiler.files.records import replace
from fretc.audit.evidence.samples import WindowSamples
from fretc.audit.evidence.schema import Result, ThresholdRecord, Violation
from fretish.bindings.amounts import declared_unit, scaled, shared_unit
from fretish.bindings.declarations import Declarations, MeasuredSignal


def in_declared_units(result: Result, declared: Declarations | None) -> Result:
    """The result with every number in the unit that the bindings declare for its signal.

    A signal that the bindings do not declare, or now in units of another dimension, stays in its
    base unit.
    """
    return result if declared is None else _result(result, declared.measured)


def thresholds_in_declared_units(
    thresholds: Sequence[ThresholdRecord], declared: Declarations | None
) -> tuple[ThresholdRecord, ...]:
    """The thresholds in declared units."""
    if declared is None:
        return tuple(thresholds)
    return tuple(_threshold(threshold, declared.measured) for threshold in thresholds)


def without_samples(results: Sequence[Result], declared: Declarations | None) -> tuple[Result, ...]:
    """Results in declared units, without the many samples around their violations.

    Args:
        results: in base units.
        declared: the bindings.
    """
    return tuple(in_declared_units(bare(result), declared) for result in results)


def bare(result: Result) -> Result:
    """The result without the samples around its violations."""
    violations = tuple(replace(violation, surroundings=None) for violation in result.violations)
    return replace(result, violations=violations)


def _result(result: Result, declared: Mapping[str, MeasuredSignal]) -> Result:
    units = {name: declared_unit(name, base, declared) for name, base in result.units.items()}
    return replace(
        result,
        units={name: unit for name, (unit, _) in units.items()},
        violations=tuple(_violation(violation, units) for violation in result.violations),
        thresholds=tuple(_threshold(threshold, declared) for threshold in result.thresholds),
    )


_Units = Mapping[str, tuple[str, Fraction]]
_ONE = ("", Fraction(1))


def _violation(violation: Violation, units: _Units) -> Violation:
    def own(name: str) -> Fraction:
        return units.get(name, _ONE)[1]

    surroundings = violation.surroundings
    return replace(
        violation,
        values={name: scaled(number, own(name)) for name, number in violation.values.items()},
        surroundings=surroundings
        and replace(
            surroundings,
            samples={name: _series(each, own(name)) for name, each in surroundings.samples.items()},
        ),
    )


def _series(series: WindowSamples, factor: Fraction) -> WindowSamples:
    if factor == 1:
        return series
    return replace(series, values=tuple(scaled(value, factor) for value in series.values))


def _threshold(
    threshold: ThresholdRecord, declared: Mapping[str, MeasuredSignal]
) -> ThresholdRecord:
    unit, factor = shared_unit(threshold.signal, threshold.unit, declared)
    if unit == threshold.unit and factor == 1:
        return threshold
    bound = scaled(threshold.bound, factor)
    if isinf(bound):
        return threshold
    return replace(
        threshold,
        unit=unit,
        bound=bound,
        least=scaled(threshold.least, factor),
        greatest=scaled(threshold.greatest, factor),
        margin=scaled(threshold.margin, factor),
    )
