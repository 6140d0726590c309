"""Checks that a requirement and its bindings mean the same.

Every proposition needs a binding.

`[proposition."(speed <= 1.5)"]` binds a comparison by its text. Without this check, a binding that
compares with another number would be audited instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import atom
from fretish import expressions as e
from fretish import units
from fretish.bindings.calculations import without_calculations
from fretish.bindings.canonical import expression as meaning
from fretish.bindings.comparisons import FUNCTIONS, bound, is_measured
from fretish.bindings.declarations import Declarations, MeasuredSignal, Proposition
from fretish.diagnostics.diagnostic import Diagnostic, suggestion
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.printer import identifier
from fretish.reading.toml_text import as_key

_MIRRORED: Mapping[str, e.ComparisonOperator] = {**e.MIRRORED, "=": "=", "!=": "!="}


def check_binding_consistency(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[Diagnostic]:
    """F524 for each comparison of the sentence that is bound to a different comparison."""
    stated = requirement.stated
    terms = _Terms.of_signals(declarations)
    for name in requirement.watched:
        proposition = declarations.propositions.get(name)
        if proposition is None or name not in stated:
            continue
        declared = without_calculations(proposition.expression)
        agreed = _agreed(stated[name], declared, declarations, terms)
        if agreed is None:
            yield _drifted(requirement, name, stated[name], proposition)
        else:
            terms = agreed


def _agreed(
    stated: e.Expression, declared: e.Expression, declarations: Declarations, terms: _Terms
) -> _Terms | None:
    """The terms extended by this comparison; None if the bound comparison differs."""
    if not isinstance(stated, e.Comparison):
        return None if any(_constant(part) is not None for part in e.parts(stated)) else terms
    if not isinstance(declared, e.Comparison):
        return None
    if is_measured(stated, declarations.measured):
        return terms if _is_same(stated, declared, declarations) else None
    sided = _constant(stated.left) is not None or _constant(stated.right) is not None
    if stated.op == declared.op:
        extended = terms.fit(stated, declared.left, declared.right)
        if extended is not None:
            return extended
    turned = sided or stated.op in ("=", "!=")  # of two names nothing says which is which
    if turned and _MIRRORED[stated.op] == declared.op:
        return terms.fit(stated, declared.right, declared.left)
    return None


def _is_same(stated: e.Comparison, declared: e.Comparison, declarations: Declarations) -> bool:
    """Whether a comparison of signals equals its declaration, each number in its unit."""
    own = bound(stated, declarations.measured, declarations.source.span(0, 0))
    if isinstance(own, Diagnostic):
        return False
    turned = e.Comparison(_MIRRORED[declared.op], declared.right, declared.left)
    return meaning(own) in (meaning(declared), meaning(turned))


class _Terms:
    """The term in the bindings for each name of a sentence; a term has no number."""

    def __init__(self, terms: Mapping[str, e.Expression], units: Mapping[_Kind, Fraction]) -> None:
        self._terms = dict(terms)
        self._units = dict(units)
        """The unit of numbers without a unit that are compared with each name."""
        self._names: tuple[str, ...] = ()
        """The names of the present comparison."""

    @classmethod
    def of_signals(cls, declarations: Declarations) -> _Terms:
        """Terms in which each signal stands for itself, even if its table has an error."""
        return cls({name: e.Name(name) for name in declarations.signal_names}, {})

    def fit(self, stated: e.Comparison, left: e.Expression, right: e.Expression) -> _Terms | None:
        """The terms extended by the comparison's, if shape and numbers of the sides agree."""
        terms = _Terms(self._terms, self._units)
        terms._names = tuple(name.id for name in e.names(stated))
        both = terms._fits(stated.left, left) and terms._fits(stated.right, right)
        return terms if both else None

    def _fits(self, stated: e.Expression, bound: e.Expression) -> bool:
        number = _constant(stated)
        if number is not None:
            return self._is_number(stated, number, bound)
        match stated, bound:
            case e.Name(id), e.Word(text):
                return id == text and self._terms.setdefault(id, bound) == bound
            case e.Name(id), _:
                plain = not any(_constant(part) is not None for part in e.parts(bound))
                return plain and self._terms.setdefault(id, bound) == bound
            case e.Negation(arg), e.Negation(other):
                return self._fits(arg, other)
            case e.Arithmetic(op, _, _), e.Arithmetic(other, _, _) if op == other:
                return self._all(stated, bound)
            case e.Call(name, _), e.Call(other, _) if FUNCTIONS.get(name) == other:
                return self._all(stated, bound)
            case _:
                return False

    def _all(self, stated: e.Expression, bound: e.Expression) -> bool:
        left, right = e.children(stated), e.children(bound)
        return len(left) == len(right) and all(map(self._fits, left, right))

    def _is_number(self, stated: e.Expression, number: Fraction, bound: e.Expression) -> bool:
        """Whether a number is bound to an equal one; without a unit it has that of the others."""
        if _units(stated):
            return bool(meaning(stated) == meaning(bound))
        if number != _constant(bound):
            return False
        kinds = [((name, u.dimension), u.factor) for u in _units(bound) for name in self._names]
        return not number or all(self._units.setdefault(*kind) == kind[1] for kind in kinds)


_Kind = tuple[str, units.Dimension]


def _units(number: e.Expression) -> list[units.Unit]:
    """The unit of a number, if it has one."""
    candidates = (units.unit(p.unit) for p in e.parts(number) if isinstance(p, e.Quantity))
    return [unit for unit in candidates if unit is not None]


def _constant(expression: e.Expression) -> Fraction | None:
    """The number as written, without its unit; None for any other expression."""
    match expression:
        case e.Number(digits) | e.Quantity(digits, _):
            return _number(digits)
        case e.Negation(arg):
            number = _constant(arg)
            return None if number is None else -number
        case _:
            return None


def _number(digits: str) -> Fraction | None:
    """The number; None if it has more digits than any binding can have."""
    try:
        return units.number(digits)
    except ValueError:
        return None


def _drifted(
    requirement: FormalizedRequirement, name: str, stated: e.Expression, bound: Proposition
) -> Diagnostic:
    span: Span | None = getattr(stated, "span", None)
    inside = span is not None and span.source is requirement.entry.wording.source
    assert bound.span is not None
    where = f"{bound.span.source.name}:{bound.span.line}:{bound.span.column}"
    return diagnostic(
        "other_comparison_bound",
        span if inside else requirement.entry.wording,
        name=name,
        requirement=requirement.id,
        text=bound.span.text,
        where=where,
        related=(bound.span,),
    )


# What has no binding ------------------------------------------


def unbound_propositions(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[Diagnostic]:
    """F304 for every proposition of the sentence without a binding.

    If a binding exists but has errors, those errors are reported instead. For a proposition no
    similar name is proposed: the nearest name may be another safety claim.
    """
    for name in requirement.watched:
        if name in declarations.propositions and not declarations.mistakes:
            continue
        mistakes = _mistakes(name, requirement.stated.get(name), declarations)
        yield from mistakes
        if mistakes or name in declarations.propositions:
            continue
        yield diagnostic(
            "unbound_proposition",
            first_use(requirement, name),
            name=name,
            requirement=requirement.id,
            source=declarations.source.name,
            help=binding_fix(requirement, name, declarations),
        )


def broken_tables(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[Diagnostic]:
    """The errors in the tables of propositions and signals that a requirement reads."""
    for name in requirement.watched if declarations.mistakes else ():
        yield from _mistakes(name, requirement.stated.get(name), declarations)


def _mistakes(
    name: str, stated: e.Expression | None, declarations: Declarations
) -> list[Diagnostic]:
    """The errors in the table of a proposition, and in those of the signals that it compares."""
    read = [("signal", name_node.id) for name_node in e.names(stated)] if stated is not None else []
    parts = [("proposition", name), *read]
    return [mistake for part in parts for mistake in declarations.mistakes.get(part, ())]


def missing_signals(
    requirement: FormalizedRequirement, name: str, signals: Mapping[str, MeasuredSignal]
) -> tuple[str, ...]:
    """The undeclared signals of a comparison, without which the comparison needs its own binding.

    With `=` and `!=`, a second name counts as a value of the first.
    """
    stated = requirement.stated.get(name)
    if not isinstance(stated, e.Comparison) or atom(stated) != name:
        return ()
    calls = {part.name for part in e.parts(stated) if isinstance(part, e.Call)}
    operators = {part.op for part in e.parts(stated) if isinstance(part, e.Arithmetic)}
    if not calls <= FUNCTIONS.keys() or operators & {"mod", "^"}:
        return ()
    words = stated.op in ("=", "!=") and isinstance(stated.left, e.Name)
    read = stated.left if words and isinstance(stated.right, e.Name) else stated
    return tuple(dict.fromkeys(part.id for part in e.names(read) if part.id not in signals))


def binding_fix(requirement: FormalizedRequirement, name: str, declarations: Declarations) -> str:
    """The fix for an unbound `name`: what to write in the bindings.

    That is signals for a comparison, a comparison for a value of a signal, else a proposition.
    """
    file = declarations.source.name
    missing = missing_signals(requirement, name, declarations.measured)
    if missing:
        near = {each: suggestion(each, declarations.measured) for each in missing}
        meant = "".join(f"did you mean `{other}`? Or " for other in near.values() if other)
        tables = " and ".join(f"`[signal.{as_key(signal_name)}]`" for signal_name in missing)
        return (
            f"{meant}add {tables} with its `path` to {file}; `fretc bind --from LOG` drafts signals"
        )
    bind = f"add `[proposition.{as_key(name)}]` with its `expr` to {file}"
    signal = next((s.name for s in declarations.measured.values() if name in s.values), None)
    if signal is None:
        return bind
    return (
        f"`{name}` is a word of `{signal}`: write `{signal} = {identifier(name)}` (as a scope "
        f"`while {signal} = {identifier(name)}`), or {bind}"
    )


def first_use(requirement: FormalizedRequirement, name: str) -> Span:
    """The span of the first use in the sentence: the name, or its comparison or call."""
    compared: Span | None = getattr(requirement.stated.get(name), "span", None)
    if compared is not None and compared.source is requirement.entry.wording.source:
        return compared
    return requirement.mentions.get(name, requirement.entry.wording)
