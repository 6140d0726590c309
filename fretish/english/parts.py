"""Parts of a reading: an expression with the words that it was made from."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.english.words import Places

_OPPOSITE: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">=", ">=": "<", ">": "<=", "<=": ">", "=": "!=", "!=": "=",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Part:
    """An expression, the places of the words that it uses, and what its names stand for."""

    expression: e.Expression
    used: Places
    names: Mapping[str, str] = field(default_factory=dict)
    """Name → the words that it stands for."""

    def with_expression(self, expression: e.Expression) -> Part:
        """The part with another expression of the same words."""
        return Part(expression, self.used, self.names)

    def negated(self) -> Part:
        """The part with the opposite expression."""
        return self.with_expression(opposite(self.expression))

    def using(self, more: Places) -> Part:
        """The part that also uses other words."""
        return Part(self.expression, self.used | more, self.names)


def opposite(expression: e.Expression) -> e.Expression:
    """The negation, without a double one; `x > 5` becomes `x <= 5`."""
    match expression:
        case e.Not(arg):
            return arg
        case e.Comparison(op, left, right):
            return e.Comparison(_OPPOSITE[op], left, right)
        case _:
            return e.Not(expression)


def joined(
    parts: Sequence[Part], join: Callable[[e.Expression, e.Expression], e.Expression]
) -> Part:
    """Several parts as one expression."""
    first, *others = parts
    for other in others:
        first = Part(
            join(first.expression, other.expression),
            first.used | other.used,
            {**first.names, **other.names},
        )
    return first
