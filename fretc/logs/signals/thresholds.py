"""Thresholds: the comparisons of a proposition between a measured number and a constant.

Numbers are in the base unit of their dimension.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from fretc.logs.signals.measures import NameValues, number
from fretish import expressions as e
from fretish.bindings.declarations import Proposition, Signal
from fretish.bindings.expressions import dimension, ticks_back
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.expressions import MIRRORED, Order
from fretish.printer import expression
from fretish.reading.caching import cache_by_identity
from fretish.units import base_name


@dataclass(frozen=True, slots=True)
class Threshold:
    """A comparison in the form `term operator bound`, with the measured number on the left."""

    proposition: str
    term: e.Expression
    """A signal, or an expression of signals: `abs(vx)`."""
    operator: Order
    bound: float
    unit: str
    """The base unit of both sides; empty for a plain number."""
    limit: e.Expression
    """The bound as written."""

    @property
    def comparison(self) -> e.Comparison:
        """The whole comparison, with the term on the left."""
        return e.Comparison(self.operator, self.term, self.limit)

    @property
    def text(self) -> str:
        """The term as it is written in the bindings."""
        return expression(self.term)


@cache_by_identity
def thresholds(proposition: Proposition, signals: Mapping[str, Signal]) -> tuple[Threshold, ...]:
    """The thresholds of a proposition, in the order of its expression.

    Excluded are equalities, to which no value is near, comparisons of two signals, comparisons with
    the tick before, and those with an undefined bound (`1 / 0`).

    Args:
        proposition: with an expression over the signals.
        signals: the declared signals.
    """
    return tuple(
        threshold
        for part in _comparisons(proposition.expression)
        if (threshold := _threshold(proposition, part, signals)) is not None
    )


def _comparisons(tree: e.Expression) -> Iterator[e.Comparison]:
    if isinstance(tree, e.Comparison):
        yield tree
    for part in e.children(tree):
        yield from _comparisons(part)


def _threshold(
    proposition: Proposition, part: e.Comparison, signals: Mapping[str, Signal]
) -> Threshold | None:
    if part.op not in MIRRORED or ticks_back(part):
        return None
    mirrored = MIRRORED[part.op]
    for term, other, operator in (
        (part.left, part.right, MIRRORED[mirrored]),
        (part.right, part.left, mirrored),
    ):
        if any(e.names(term)) and not any(e.names(other)):
            bound = float(number(other, NameValues(1, {}))[0])
            unit = _unit(term, signals)
            return (
                Threshold(proposition.name, term, operator, bound, unit, other)
                if isfinite(bound)
                else None
            )
    return None


def _unit(term: e.Expression, signals: Mapping[str, Signal]) -> str:
    kinds = {name: signal.unit.dimension for name, signal in signals.items()}
    kind = dimension(term, kinds, Source("", "").span())
    assert kind is not None, "a comparison is of numbers"
    assert not isinstance(kind, Diagnostic), "the reader of bindings refuses such an expression"
    return base_name(kind)
