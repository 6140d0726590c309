"""Parts of a sentence that are always true or always false, whatever is measured.

Only what comparisons make constant counts: `battery < 20 & battery > 30`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import MOST_ATOMS, impossible_combinations, temporal_predicate
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate
from compiler.logic.orders import Exclusion, only_possible
from fretish import expressions as e
from fretish.checking import conditions
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import ScopeKind

_ByFirst = Mapping[str, Sequence[Exclusion]]
"""Impossible combinations by their first comparison, so that each part checks only those that
concern it."""


@with_recursion_limit
def constant_parts(requirement: FormalizedRequirement) -> tuple[tuple[e.Expression, bool], ...]:
    """Each outermost part with a constant truth value, and that value.

    The condition of a scope is checked together with its mode.
    """
    impossible: dict[str, list[Exclusion]] = {}
    for exclusion in impossible_combinations(requirement):
        impossible.setdefault(exclusion[0][0], []).append(exclusion)
    if not impossible or temporal_predicate(requirement.sentence):
        return ()
    parts = tuple(_constant(tuple(conditions(requirement.sentence)), impossible))
    scope, condition = requirement.sentence.scope, requirement.sentence.condition
    if parts or not scope or not condition or scope.kind is not ScopeKind.IN:
        return parts
    return tuple(_constant([e.both(scope.mode, condition.expression)], impossible))


def _constant(
    parts: Sequence[e.Expression], impossible: _ByFirst
) -> Iterator[tuple[e.Expression, bool]]:
    waiting = [*reversed(parts)]
    while waiting:
        part = waiting.pop()
        value = _value(part, impossible)
        if value is not None:
            yield part, value
        elif not isinstance(part, e.Comparison | e.Call):
            waiting.extend(reversed(e.children(part)))


def _value(part: e.Expression, impossible: _ByFirst) -> bool | None:
    """The value of the part if it is constant over exactly the possible valuations; else None."""
    formula = boolean(part, Uninterpreted().alone())
    atoms = tuple(dict.fromkeys(f.atoms(formula)))
    if not atoms or len(atoms) > MOST_ATOMS:
        return None
    every = tuple(product((False, True), repeat=len(atoms)))
    exclusions = [exclusion for name in atoms for exclusion in impossible.get(name, ())]
    possible = only_possible(every, atoms, exclusions)
    values, all_ = ({*_values(formula, atoms, valuations)} for valuations in (possible, every))
    return values.pop() if len(values) == 1 and len(all_) == 2 else None


def _values(
    formula: f.Formula, atoms: Sequence[str], valuations: Sequence[tuple[bool, ...]]
) -> Iterator[bool]:
    columns = {
        name: sum(values[i] << k for k, values in enumerate(valuations))
        for i, name in enumerate(atoms)
    }
    column = evaluate(formula, columns, len(valuations))
    return (bool(column >> k & 1) for k in range(len(valuations)))
