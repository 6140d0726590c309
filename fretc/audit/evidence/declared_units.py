"""Evidence and results in the units that the bindings declare, for every output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import isinf

from compiler.files.records import replace
from fretc.audit.evidence.samples import Series
from fretc.audit.evidence.schema import Evidence, Result, Threshold, Violation
from fretish.bindings.amounts import declared_unit, scaled, shared_unit
from fretish.bindings.declarations import Declarations, Signal


def in_declared_units(evidence: Evidence, declared: Declarations | None) -> Evidence:
    """The same evidence with every number in the unit that the bindings declare for its signal.

    A signal that the bindings do not declare, or now in units of another dimension, stays in its
    base unit.
    """
    if declared is None:
        return evidence
    return evidence.with_results([_result(each, declared.signals) for each in evidence.results])


def without_samples(results: Sequence[Result], declared: Declarations | None) -> tuple[Result, ...]:
    """Results as above, without the samples around their violations: those are many.

    Args:
        results: in base units.
        declared: the bindings.
    """
    bare = [
        replace(each, violations=tuple(replace(v, surroundings=None) for v in each.violations))
        for each in results
    ]
    return tuple(_result(each, declared.signals) if declared else each for each in bare)


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


def _series(series: Series, factor: Fraction) -> Series:
    if factor == 1:
        return series
    return replace(series, values=tuple(scaled(value, factor) for value in series.values))


def _threshold(threshold: Threshold, declared: Mapping[str, Signal]) -> Threshold:
    unit, factor = shared_unit(threshold.signal, threshold.unit, declared)
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
