"""Whether a comparison that a sentence states is the one that its binding makes.

`[proposition."(speed <= 1.5)"]` binds a comparison by its text. Nothing else holds the two
together: a binding that compares with another number would be audited in its place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from compiler.formalization.obligation import atom, variable
from compiler.formalization.rule import Rule
from fretish import expressions as e
from fretish import units
from fretish.bindings.declarations import Declarations, Proposition
from fretish.checking import conditions
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.parser import parse
from fretish.syntax import Sentence

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}
_FUNCTIONS = {
    "absReal": "abs", "absInt": "abs",
    "maxReal": "max", "maxInt": "max", "minReal": "min", "minInt": "min",
}  # fmt: skip
"""What a function of sentences is called in bindings."""


def disagreements(rule: Rule, declarations: Declarations) -> Iterator[Diagnostic]:
    """F524 for each comparison of the sentence that is bound to another one."""
    stated = _stated(rule.sentence)
    for name in rule.watched:
        bound = declarations.propositions.get(name)
        if bound is None or name not in stated:
            continue
        if not _agrees(stated[name], bound.expression, declarations):
            yield _drifted(rule, name, stated[name], bound)


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


def _agrees(stated: e.Expression, bound: e.Expression, declarations: Declarations) -> bool:
    if not isinstance(stated, e.Comparison):
        return not any(_constant(part) is not None for part in _parts(stated))
    if not isinstance(bound, e.Comparison):
        return False
    if stated.op == bound.op and _Terms(declarations).fit(
        (stated.left, bound.left), (stated.right, bound.right)
    ):
        return True
    sided = _constant(stated.left) is not None or _constant(stated.right) is not None
    turned = sided or stated.op in ("=", "!=")  # of two names nothing says which is which
    return (
        turned
        and _MIRRORED[stated.op] == bound.op
        and _Terms(declarations).fit((stated.left, bound.right), (stated.right, bound.left))
    )


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
            case e.Name(id), _:
                plain = not any(_constant(part) is not None for part in _parts(bound))
                return plain and self._terms.setdefault(id, bound) == bound
            case e.Negation(arg), e.Negation(other):
                return self._fits(arg, other)
            case e.Arithmetic(op, _, _), e.Arithmetic(other, _, _) if op == other:
                return self._all(stated, bound)
            case e.Call(name, _), e.Call(other, _) if _FUNCTIONS.get(name) == other:
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


def _parts(expression: e.Expression) -> Iterator[e.Expression]:
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        yield part
        waiting.extend(e.children(part))


def _drifted(rule: Rule, name: str, stated: e.Expression, bound: Proposition) -> Diagnostic:
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
