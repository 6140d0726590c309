"""Numbers at thresholds as atoms: a situation requires a number at its tick.

Such an atom belongs to an auxiliary sentence, which is formalized like a requirement, so that
names, units and signals are read in the same way.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.situations.situations import Situation
from fretc.analysis.arena.variables import UnsupportedError
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.expressions import ticks_back
from fretish.diagnostics.source import Source
from fretish.printer import sentence as printed


class Places:
    """The thresholds of one requirement."""

    def __init__(self, requirement: FormalizedRequirement) -> None:
        self._rule = requirement
        self._found: dict[e.Expression, FormalizedRequirement | None] = {}
        self.pinned: defaultdict[str, set[f.Formula]] = defaultdict(set)
        """Signal → formulas that fix its number, and that propositions agree with it."""

    @property
    def carriers(self) -> Iterator[FormalizedRequirement]:
        """Auxiliary sentences of all atoms so far."""
        return (each for each in self._found.values() if each is not None)

    def formula(self, situation: Situation) -> f.Formula:
        """Formula of a situation, with its number.

        Raises:
            UnsupportedError: the number cannot be written over signals.
        """
        place = situation.place
        if place is None:
            return situation.formula
        read = {name.id for name in e.names(place.measured)}
        pinned = f.and_(self._carried(place.exact), *self._agreements(read))
        for name in read:
            self.pinned[name].add(pinned)
        return f.and_(situation.formula, pinned)

    def _agreements(self, signals: set[str]) -> Iterator[f.Formula]:
        """Formulas of the propositions over these signals, for ticks with one sample."""
        declared = self._rule.declarations
        for name in self._rule.watched:
            bound = declared.propositions.get(name) if declared else None
            if bound is None or signals.isdisjoint(bound.signals):
                continue
            expression = bound.expression
            if isinstance(
                expression, e.Persistence
            ):  # It has held for some time, so it holds here.
                yield f.implies(f.Atom(name), self._carried(expression.arg))
            elif any(isinstance(each, e.Persistence) for each in e.parts(expression)):
                raise UnsupportedError(f"`{name}` looks at more than one tick")
            else:
                yield f.iff(f.Atom(name), self._carried(expression))

    def _carried(self, expression: e.Expression) -> f.Formula:
        """Expression over the atoms of a sentence with it as response."""
        if expression not in self._found:
            self._found[expression] = self._carrier(expression)
        carrier = self._found[expression]
        if carrier is None or ticks_back(expression):
            raise UnsupportedError("its number cannot be written in a sentence")
        return boolean(carrier.sentence.response, Uninterpreted().alone())

    def _carrier(self, expression: e.Expression) -> FormalizedRequirement | None:
        written = replace(
            self._rule.written,
            scope=None,
            condition=None,
            probability=None,
            timing=s.Always(),
            response=_as_written(expression),
        )
        requirement = self._rule.entry
        source = Source(requirement.wording.source.name, printed(written))
        made, _ = formalize(replace(requirement, wording=source.span()), self._rule.declarations)
        return made


_CALLS = {"abs": "absReal", "min": "minReal", "max": "maxReal"}
"""Function names of bindings → names in sentences."""


def _as_written(expression: e.Expression) -> e.Expression:
    """Expression of bindings in the syntax of sentences."""
    parts = [_as_written(each) for each in e.children(expression)]
    if isinstance(expression, e.Call):
        return replace(
            expression, name=_CALLS.get(expression.name, expression.name), args=(*parts,)
        )
    return e.with_children(expression, parts) if parts else expression
