"""Whether what a requirement states is what its bindings make of it.

A proposition needs a binding.

`[proposition."(speed <= 1.5)"]` binds a comparison by its text. Nothing else holds the two
together: a binding that compares with another number would be audited in its place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from compiler.formalization.formalized import Formalized
from compiler.formalization.obligation import atom, variable
from fretish import expressions as e
from fretish import units
from fretish.bindings.canonical import expression as meaning
from fretish.bindings.comparisons import FUNCTIONS, bound, is_measured
from fretish.bindings.declarations import Declarations, Proposition, Signal
from fretish.checking import conditions
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.parser import parse
from fretish.printer import identifier
from fretish.reading.toml_text import as_key
from fretish.syntax import Sentence

_MIRRORED: Mapping[str, e.ComparisonOperator] = {**e.MIRRORED, "=": "=", "!=": "!="}


def disagreements(rule: Formalized, declarations: Declarations) -> Iterator[Diagnostic]:
    """F524 for each comparison of the sentence that is bound to another one."""
    stated = _stated(rule.sentence)
    for name in rule.watched:
        proposition = declarations.propositions.get(name)
        if proposition is None or name not in stated:
            continue
        if not _agrees(stated[name], proposition.expression, declarations):
            yield _drifted(rule, name, stated[name], proposition)


def _stated(sentence: Sentence) -> Mapping[str, e.Expression]:
    """The comparisons and calls of a sentence, by the names that formulas give them.

    So is a name in quotes that reads as a comparison.
    """
    found: dict[str, e.Expression] = {}
    waiting = list(conditions(sentence))
    while waiting:
        part = waiting.pop()
        if isinstance(part, e.Comparison | e.Call):
            found[atom(part)] = part
        elif isinstance(part, e.Name):
            quoted = _quoted(part)
            found |= {variable(part.id): quoted} if quoted is not None else {}
        waiting.extend(e.children(part))
    return found


def _quoted(name: e.Name) -> e.Comparison | None:
    """What the letters of a name in quotes say, where that is a comparison."""
    if not any(sign in name.id for sign in "<>="):
        return None
    read = parse(Source("name", f"the component shall satisfy ({name.id})").span())
    response = read.response if isinstance(read, Sentence) else None
    return response if isinstance(response, e.Comparison) else None


def _agrees(stated: e.Expression, declared: e.Expression, declarations: Declarations) -> bool:
    if not isinstance(stated, e.Comparison):
        return not any(_constant(part) is not None for part in e.parts(stated))
    if not isinstance(declared, e.Comparison):
        return False
    if is_measured(stated, declarations.signals):
        return _is_same(stated, declared, declarations)
    if stated.op == declared.op and _Terms(declarations).fit(
        (stated.left, declared.left), (stated.right, declared.right)
    ):
        return True
    sided = _constant(stated.left) is not None or _constant(stated.right) is not None
    turned = sided or stated.op in ("=", "!=")  # of two names nothing says which is which
    return (
        turned
        and _MIRRORED[stated.op] == declared.op
        and _Terms(declarations).fit((stated.left, declared.right), (stated.right, declared.left))
    )


def _is_same(stated: e.Comparison, declared: e.Comparison, declarations: Declarations) -> bool:
    """Whether a comparison of signals means what is declared for it, each number in its unit."""
    own = bound(stated, declarations.signals, declarations.source.span(0, 0))
    if isinstance(own, Diagnostic):
        return False
    turned = e.Comparison(_MIRRORED[declared.op], declared.right, declared.left)
    return meaning(own) in (meaning(declared), meaning(turned))


class _Terms:
    """What each name of a comparison stands for in the binding: one term, without a number."""

    def __init__(self, declarations: Declarations) -> None:
        names = declarations.signal_names  # a signal with a mistake is still that signal
        self._terms: dict[str, e.Expression] = {name: e.Name(name) for name in names}

    def fit(self, *pairs: tuple[e.Expression, e.Expression]) -> bool:
        """Whether each stated expression has the shape and the numbers of the bound one."""
        return all(self._fits(stated, bound) for stated, bound in pairs)

    def _fits(self, stated: e.Expression, bound: e.Expression) -> bool:
        number = _constant(stated)
        if number is not None:
            return number == _constant(bound)
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
        return len(left) == len(right) and self.fit(*zip(left, right, strict=True))


def _constant(expression: e.Expression) -> Fraction | None:
    """The number as it is written, whatever its unit; None for anything else."""
    match expression:
        case e.Number(digits) | e.Quantity(digits, _):
            return _number(digits)
        case e.Negation(arg):
            number = _constant(arg)
            return None if number is None else -number
        case _:
            return None


def _number(digits: str) -> Fraction | None:
    """None where it has more digits than any binding can have: nothing is equal to it."""
    try:
        return units.number(digits)
    except ValueError:
        return None


def _drifted(rule: Formalized, name: str, stated: e.Expression, bound: Proposition) -> Diagnostic:
    place: Span | None = getattr(stated, "span", None)
    inside = place is not None and place.source is rule.requirement.wording.source
    assert bound.span is not None
    where = f"{bound.span.source.name}:{bound.span.line}:{bound.span.column}"
    return Diagnostic(
        Code.NUMBER_DRIFT,
        f"`{name}` of {rule.id} is bound to another comparison: {bound.span.text} ({where})",
        place if inside else rule.requirement.wording,
        help="state the operator and the number of the sentence in the binding, the number with "
        "its unit, or give the proposition a name without a number",
    )


# What has no binding ------------------------------------------


def unbound(rule: Formalized, declarations: Declarations) -> Iterator[Diagnostic]:
    """F304 for every proposition of the sentence that the bindings do not have.

    Where they have one that cannot be used, it is the mistakes in its tables. No other proposition
    is proposed in its place: the nearest name may be another safety claim.
    """
    for name in rule.watched:
        mistakes = _mistakes(rule, name, declarations)
        yield from mistakes
        if mistakes or name in declarations.propositions:
            continue
        yield Diagnostic(
            Code.UNBOUND,
            f"`{name}` of {rule.id} has no binding in {declarations.source.name}",
            place(rule, name),
            help=_way_out(rule, name, declarations),
        )


def _mistakes(rule: Formalized, name: str, declarations: Declarations) -> list[Diagnostic]:
    """Those of its own table, and of the signals that it compares."""
    stated = _stated(rule.sentence).get(name)
    read = [("signal", each.id) for each in e.names(stated)] if stated is not None else []
    parts = [("proposition", name), *read]
    return [mistake for part in parts for mistake in declarations.mistakes.get(part, ())]


def missing_signals(rule: Formalized, name: str, signals: Mapping[str, Signal]) -> tuple[str, ...]:
    """The signals that a comparison of the sentence lacks, without which it must be bound itself.

    Beside `=` and `!=` a second name is taken for a word of the first.
    """
    stated = _stated(rule.sentence).get(name)
    if not isinstance(stated, e.Comparison) or atom(stated) != name:
        return ()
    calls = {part.name for part in e.parts(stated) if isinstance(part, e.Call)}
    operators = {part.op for part in e.parts(stated) if isinstance(part, e.Arithmetic)}
    if not calls <= FUNCTIONS.keys() or operators & {"mod", "^"}:
        return ()
    words = stated.op in ("=", "!=") and isinstance(stated.left, e.Name)
    read = stated.left if words and isinstance(stated.right, e.Name) else stated
    return tuple(dict.fromkeys(each.id for each in e.names(read) if each.id not in signals))


def _way_out(rule: Formalized, name: str, declarations: Declarations) -> str:
    """Signals for a comparison; a comparison for the word of a signal; else a binding."""
    missing = missing_signals(rule, name, declarations.signals)
    if missing:
        tables = " and ".join(f"`[signal.{as_key(each)}]`" for each in missing)
        return f"add {tables} there; `fretc bind --from LOG` drafts signals"
    bind = f"add `[proposition.{as_key(name)}]` there"
    signal = next((s.name for s in declarations.signals.values() if name in s.values), None)
    if signal is None:
        return bind
    return (
        f"`{name}` is a word of `{signal}`: write `{signal} = {identifier(name)}` (as a scope "
        f"`while {signal} = {identifier(name)}`), or {bind}"
    )


def place(rule: Formalized, name: str) -> Span:
    """Where the sentence names it first: the name, or the comparison or the call that it is of."""
    compared: Span | None = getattr(_stated(rule.sentence).get(name), "span", None)
    if compared is not None and compared.source is rule.requirement.wording.source:
        return compared
    for expression in conditions(rule.sentence):
        for mention in e.names(expression):
            if mention.id == name and mention.span is not None:
                return mention.span
    return rule.requirement.wording
