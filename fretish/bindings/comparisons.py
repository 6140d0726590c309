"""Units of numbers in the comparisons of sentences.

A bare number has the unit of the signal that it is compared with or added to, as in FRET, where
variables have no units. A number with a unit is converted exactly into that unit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from fretish import expressions as e
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import MeasuredSignal
from fretish.bindings.expressions import MOST_TICKS_BACK, is_base, ticks_back
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import as_key
from fretish.units import (
    DIMENSIONLESS,
    ONE,
    Unit,
    is_vague,
    number,
    times,
    unit,
    unit_product,
    unit_quotient,
)

FUNCTIONS = {
    "absReal": "abs", "absInt": "abs",
    "maxReal": "max", "maxInt": "max", "minReal": "min", "minInt": "min",
    "preReal": "pre", "preInt": "pre",
}  # fmt: skip
"""Function in a sentence → the same function in bindings."""


class _ComparisonError(DiagnosticError):
    """Carries a diagnostic out of the recursion."""


@dataclass(frozen=True, slots=True)
class _NumberUnit:
    """The unit of the numbers in an expression."""

    name: str
    """The unit as written; empty for plain numbers."""
    unit: Unit
    measured: bool
    """Whether a signal determines the unit; if not, quantities are converted."""
    mixed: bool = False
    """Whether the expression combines signals in different units of one dimension."""
    vague: bool = False
    """Whether a bare number in this unit is implausible, as in cm/m."""


_PLAIN = _NumberUnit("", ONE, measured=False)


def is_measured(expression: e.Expression, signals: Mapping[str, MeasuredSignal]) -> bool:
    """Whether every name is a signal, and bindings support every operation in the expression."""
    parts = list(e.parts(expression))
    names = {part.id for part in parts if isinstance(part, e.Name)}
    calls = {part.name for part in parts if isinstance(part, e.Call)}
    known = names <= signals.keys() and calls <= FUNCTIONS.keys()
    computable = known and all(map(_is_computable, parts))
    return bool(names) and computable and ticks_back(expression) <= MOST_TICKS_BACK


def _is_computable(part: e.Expression) -> bool:
    """Whether bindings support this power or call, with this number of arguments."""
    match part:
        case e.Arithmetic("^", base, exponent):
            return is_base(base) and _exponent(exponent) is not None
        case e.Call(name, args) if FUNCTIONS.get(name) in _ARITY:
            return len(args) == _ARITY[FUNCTIONS[name]]
        case _:
            return True


_ARITY = {"abs": 1, "pre": 2}
"""Function → number of its arguments."""


def _exponent(written: e.Expression) -> int | None:
    """The exponent, if it is a literal from 1 to `MOST_EXPONENT`; else None."""
    match written:
        case e.Number(digits) if _is_number(digits):
            exact = number(digits)
            return int(exact) if exact in range(1, e.MOST_EXPONENT + 1) else None
        case _:
            return None


def in_own_units(
    comparison: e.Comparison, signals: Mapping[str, MeasuredSignal], span: Span
) -> e.Comparison | Diagnostic:
    """The comparison with each quantity (`20 %`) as a bare number in the unit of its signal.

    FRET, formulas and monitors use this form. If the comparison combines signals in different
    units of one dimension, its quantities keep their units.

    Args:
        comparison: a comparison of a sentence for which `is_measured` is true.
        signals: the declared signals.
        span: the span of a diagnostic about a part without a span.
    """
    return _ComparisonRewriter(signals, span, bare=True).comparison(comparison)


def bound(
    comparison: e.Comparison, signals: Mapping[str, MeasuredSignal], span: Span
) -> e.Comparison | Diagnostic:
    """The comparison as an expression of bindings, in which each number has its unit."""
    rewritten = _ComparisonRewriter(signals, span, bare=False).comparison(comparison)
    if isinstance(rewritten, Diagnostic):
        return rewritten
    kinds = {name: signal.unit.dimension for name, signal in signals.items()}
    dimension = binding.dimension(rewritten, kinds, comparison.span or span)
    return dimension if isinstance(dimension, Diagnostic) else rewritten


def is_mixed(comparison: e.Comparison, signals: Mapping[str, MeasuredSignal], span: Span) -> bool:
    """Whether the comparison combines signals in different units of one dimension."""
    return is_measured(comparison, signals) and _ComparisonRewriter(
        signals, span, bare=True
    ).is_mixed(comparison)


class _ComparisonRewriter:
    """Rewrites the numbers of a comparison into the units that their operands require."""

    def __init__(self, signals: Mapping[str, MeasuredSignal], span: Span, *, bare: bool) -> None:
        self._signals = signals
        self._place = span
        self._bare = bare
        self._measures: dict[int, _NumberUnit | None] = {}
        """`id(part)` → its unit. Hashing a tree would take time proportional to its size."""

    def comparison(self, comparison: e.Comparison) -> e.Comparison | Diagnostic:
        sides = (comparison.left, comparison.right)
        try:
            common = self._common_measure(sides)
            left, right = (self._rewrite(side, common) for side in sides)
        except _ComparisonError as error:
            return error.diagnostic
        return replace(comparison, left=left, right=right)

    def is_mixed(self, comparison: e.Comparison) -> bool:
        """Whether signals of one dimension have different units."""
        try:
            return self._common_measure((comparison.left, comparison.right)).mixed
        except _ComparisonError:
            return False

    # Units

    def _measure(self, part: e.Expression) -> _NumberUnit | None:
        """The unit of a part; None if it consists of bare numbers only."""
        if id(part) not in self._measures:
            self._measures[id(part)] = self._compute_measure(part)
        return self._measures[id(part)]

    def _compute_measure(self, part: e.Expression) -> _NumberUnit | None:
        match part:
            case e.Number():
                return None
            case e.Quantity(_, name, span):
                return _NumberUnit(name, self._unit(name, span), measured=False)
            case e.Name(id):
                signal = self._signals[id]
                return _NumberUnit(signal.unit_name, signal.unit, measured=True)
            case e.Arithmetic("*" | "/" as op, left, right):
                return self._product(op, left, right)
            case e.Arithmetic("^", base, exponent):
                return self._power(base, exponent)
            case _:
                parts = e.children(part)
                plain = all(self._measure(operand) is None for operand in parts)
                return None if plain else self._common_measure(parts)

    def _unit(self, name: str, span: Span | None) -> Unit:
        """The unit of a quantity; F339 if a part of its name is also a signal."""
        kinds = {id: signal.unit.dimension for id, signal in self._signals.items()}
        kind = binding.dimension(e.Quantity("1", name, span), kinds, self._place)
        if isinstance(kind, Diagnostic):
            raise _ComparisonError(kind)
        known = unit(name)
        assert known is not None, "the lexer knows all units"
        return known

    def _product(self, op: str, left: e.Expression, right: e.Expression) -> _NumberUnit | None:
        first, second = self._measure(left), self._measure(right)
        if first is None and second is None:
            return None
        a, b = _factor_measure(first), _factor_measure(second)
        combined = times(a.unit, b.unit, 1 if op == "*" else -1)
        name = unit_product(a.name, b.name) if op == "*" else unit_quotient(a.name, b.name)
        both = bool(a.name and b.name)
        vague = a.vague or b.vague or (both and is_vague(name))
        return _NumberUnit(name, combined, a.measured or b.measured, a.mixed or b.mixed, vague)

    def _power(self, base: e.Expression, exponent: e.Expression) -> _NumberUnit | None:
        first, count = self._measure(base), _exponent(exponent)
        assert count is not None, "the comparison is measured"
        if first is None:
            return None
        name, combined = first.name, first.unit
        for _ in range(count - 1):
            name, combined = unit_product(name, first.name), times(combined, first.unit)
        return replace(first, name=name, unit=combined)

    def _common_measure(self, parts: Sequence[e.Expression]) -> _NumberUnit:
        """The common unit of parts that are compared or added: the unit of their signals."""
        measures = [(part, m) for part in parts if (m := self._measure(part)) is not None]
        if not measures:
            return _PLAIN
        _, first = measures[0]
        for part, other in measures:
            if other.unit.dimension != first.unit.dimension:
                raise _ComparisonError(self._different(measures, first, other, part))
        measured = [m for _, m in measures if m.measured]
        mixed = len({m.unit.factor for m in measured}) > 1 or any(m.mixed for m in measured)
        vague = any(m.vague for _, m in measures)
        return replace(measured[0] if measured else first, mixed=mixed, vague=vague)

    def _different(
        self,
        measures: Sequence[tuple[e.Expression, _NumberUnit]],
        first: _NumberUnit,
        other: _NumberUnit,
        part: e.Expression,
    ) -> Diagnostic:
        """F305 for a part of another dimension than the first; a signal without unit is named."""
        known = next(each for each in (first, other) if each.unit.dimension != DIMENSIONLESS)
        plain = [{name.id for name in e.names(each)} for each, m in measures if not m.name]
        for name in (next(iter(names)) for names in plain if len(names) == 1):
            if not self._signals[name].unit_name:
                return diagnostic(
                    "signal_without_unit",
                    self._span(part),
                    name=name,
                    key=as_key(name),
                    unit=known.name,
                )
        return _mismatch(first, other, self._span(part))

    def _span(self, part: e.Expression) -> Span:
        return getattr(part, "span", None) or self._place

    # Numbers

    def _rewrite(self, part: e.Expression, target: _NumberUnit) -> e.Expression:
        """The part with its numbers converted into the target's unit."""
        if self._measure(part) is None:
            return self._constant(part, target)
        match part:
            case e.Quantity():
                return self._quantity(part, target)
            case e.Negation(arg):
                return replace(part, arg=self._rewrite(arg, target))
            case e.Arithmetic("*" | "/", left, right):
                return self._rewrite_product(part, left, right, target)
            case e.Arithmetic("^"):
                return self._rewrite_power(part, target)
            case e.Arithmetic(_, left, right):
                left, right = self._rewrite(left, target), self._rewrite(right, target)
                return replace(part, left=left, right=right)
            case e.Call(name, args):
                called = name if self._bare else FUNCTIONS[name]
                return replace(
                    part, name=called, args=tuple(self._rewrite(a, target) for a in args)
                )
            case _:
                return part

    def _constant(self, part: e.Expression, target: _NumberUnit) -> e.Expression:
        """A part of bare numbers only, with the target's unit attached where bindings need it."""
        for operand in e.parts(part):
            if isinstance(operand, e.Number) and not _is_number(operand.digits):
                raise _ComparisonError(diagnostic("number_too_long", self._span(operand)))
        zero = isinstance(part, e.Number) and number(part.digits) == 0
        if (target.mixed or target.vague) and not zero:
            raise _ComparisonError(_ambiguous_unit(self._span(part), target))
        if self._bare:
            return part
        part = _spell_in_bindings(part)
        if not target.name:
            return part
        if unit(target.name) is None:
            raise _ComparisonError(_ambiguous_unit(self._span(part), target))
        if isinstance(part, e.Number):
            return e.Quantity(part.digits, target.name, part.span)
        if isinstance(part, e.Negation):
            return replace(part, arg=self._constant(part.arg, target))
        return e.Arithmetic("*", part, e.Quantity("1", target.name))

    def _quantity(self, quantity: e.Quantity, target: _NumberUnit) -> e.Expression:
        if not self._bare or target.mixed:
            return quantity
        factor = self._unit(quantity.unit, quantity.span).factor / target.unit.factor
        return plain(number(quantity.digits) * factor, quantity.span)

    def _rewrite_product(
        self, part: e.Arithmetic, left: e.Expression, right: e.Expression, target: _NumberUnit
    ) -> e.Expression:
        """A product or quotient: signals keep their units, quantities get base units.

        A product of quantities only is converted as a whole.
        """
        if self._keeps_units(part, target):
            return part
        product = replace(
            part,
            left=self._factor(left),
            right=self._factor(right),
        )
        return self._convert(product, part, target)

    def _keeps_units(self, part: e.Expression, target: _NumberUnit) -> bool:
        """Whether quantities keep their units because signals with different units are combined."""
        own = self._measure(part)
        return self._bare and target.mixed and own is not None and not own.measured

    def _rewrite_power(self, part: e.Arithmetic, target: _NumberUnit) -> e.Expression:
        """A power: the base keeps its unit, and the result is converted."""
        if self._keeps_units(part, target):
            return part
        power = replace(part, left=self._rewrite(part.left, self._measure(part.left) or _PLAIN))
        if not self._bare:  # bindings write exponents with digits alone
            power = replace(power, right=e.Number(str(_exponent(part.right))))
        return self._convert(power, part, target)

    def _convert(
        self, product: e.Arithmetic, part: e.Arithmetic, target: _NumberUnit
    ) -> e.Expression:
        """The rewritten part, converted to the target's unit if it contains no signal."""
        own = self._measure(part)
        assert own is not None
        if not self._bare or own.measured or own.unit == target.unit:
            return product
        ratio = plain(own.unit.factor / target.unit.factor, part.span)
        return e.Arithmetic("*", product, ratio, part.span)

    def _factor(self, part: e.Expression) -> e.Expression:
        """An operand of a product. The unit of a bare number added to a quantity is ambiguous."""
        measure = self._measure(part)
        target = _factor_measure(measure)
        added = measure is not None and not measure.measured
        return self._rewrite(part, replace(target, vague=target.vague or added))


def _factor_measure(measure: _NumberUnit | None) -> _NumberUnit:
    """The unit of a factor: quantities are in base units, so `50 %` is 0.5."""
    if measure is None:
        return _PLAIN
    if measure.measured:
        return measure
    dimension = measure.unit.dimension
    vague = measure.vague or (dimension != DIMENSIONLESS and measure.unit.factor != 1)
    base = Unit(dimension, Fraction(1))
    return _NumberUnit(str(base), base, measured=False, vague=vague)


def plain(exact: Fraction, span: Span | None = None) -> e.Expression:
    """An exact number as FRETish text allows it: a finite decimal, else a quotient."""
    rest, digits = exact.denominator, 0
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
            digits += 1
    if rest != 1:
        over = e.Number(str(exact.denominator), span)
        return e.Arithmetic("/", e.Number(str(exact.numerator), span), over, span)
    scaled = exact * 10**digits
    text = str(scaled.numerator).rjust(digits + 1, "0")
    whole, fraction = text[: len(text) - digits], text[len(text) - digits :].rstrip("0")
    return e.Number(f"{whole}.{fraction}" if fraction else whole, span)


def _spell_in_bindings(part: e.Expression) -> e.Expression:
    """An expression of bare numbers with the function names and exponents of bindings."""
    parts = [_spell_in_bindings(operand) for operand in e.children(part)]
    match e.with_children(part, parts):
        case e.Call(name, _) as call:
            return replace(call, name=FUNCTIONS.get(name, name))
        case e.Arithmetic("^", _, exponent) as power:
            return replace(power, right=e.Number(str(_exponent(exponent))))
        case other:
            return other


def _is_number(digits: str) -> bool:
    try:
        number(digits)
    except ValueError:
        return False
    return True


def _describe(measure: _NumberUnit) -> str:
    if measure.unit.dimension == DIMENSIONLESS:
        return "a number without a unit"
    return f"a quantity in {measure.name}"


def _mismatch(left: _NumberUnit, right: _NumberUnit, span: Span) -> Diagnostic:
    return diagnostic("quantities_differ", span, left=_describe(left), right=_describe(right))


def _ambiguous_unit(span: Span, target: _NumberUnit) -> Diagnostic:
    plain = target.unit.dimension == DIMENSIONLESS
    return diagnostic(
        "ambiguous_number",
        span,
        help="write it in percent: 2 is `200 %`" if plain else "write its unit: `5 m/s`",
    )
