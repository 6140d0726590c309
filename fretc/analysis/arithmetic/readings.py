"""Expressions of atoms over the samples of a tick, according to the bindings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import all_comparisons
from compiler.formalization.resolution import candidates
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate, Declarations, Signal
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class AtomReading:
    """Expression of an atom over the samples of a tick."""

    expression: e.Expression
    names: tuple[str, ...]
    """Names in the sentence; the player who chooses them chooses the signals."""
    aggregate: Aggregate = Aggregate.LAST
    on_unknown: bool | None = None
    """Value if its signals are unknown; None: unknown, too."""
    period: int | None = None
    """Length of a tick in nanoseconds; None: the clock has no period."""

    @property
    def is_of_moment(self) -> bool:
        """Whether a single known sample decides the atom."""
        lasts = any(isinstance(part, e.Persistence) for part in e.parts(self.expression))
        return self.aggregate is Aggregate.LAST and self.on_unknown is None and not lasts


def readings(requirements: Sequence[FormalizedRequirement]) -> Iterator[tuple[str, AtomReading]]:
    """The reading of each atom that compares numbers or enumeration values, by its name."""
    for requirement in requirements:
        compared, declared = all_comparisons(requirement), requirement.declarations
        for name, comparison in compared.items():
            if not _is_computed(comparison, declared):
                yield name, AtomReading(comparison, _names(comparison))
        for name, part in candidates(requirement.sentence):
            bound = declared.propositions.get(name) if declared is not None else None
            if declared is None or bound is None:
                continue
            if name in compared and not _is_computed(compared[name], declared):
                continue
            if _is_measured(bound.expression, declared.signals):
                own = bound.aggregate, bound.on_unknown, declared.clock.period
                yield name, AtomReading(bound.expression, _names(part), *own)


def _is_computed(comparison: e.Comparison, declarations: Declarations | None) -> bool:
    """Whether it names a computed signal, which depends on others: its expression is read."""
    names = {name.id for name in e.names(comparison)}
    return declarations is not None and not names.isdisjoint(declarations.computed)


def _names(part: e.Expression) -> tuple[str, ...]:
    return tuple(dict.fromkeys(each.id for each in e.names(part)))


def _is_measured(expression: e.Expression, signals: Mapping[str, Signal]) -> bool:
    """Whether the atom compares numbers of signals in their own units, at one tick."""
    read = [signals.get(name.id) for name in e.names(expression)]
    return (
        bool(read)
        and not any(e.truths(expression))
        and not ticks_back(expression)
        and all(each is not None and each.scale == each.unit.factor for each in read)
    )
