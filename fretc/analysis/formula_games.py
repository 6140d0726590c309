"""Components with formulas that have no deterministic Büchi automaton, decided by Spot's games.

Only the verdict is known then: no play, no conflict, no strategy.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import all_comparisons, temporal_predicate
from compiler.logic import formula as f
from compiler.logic import spot
from fretc.analysis.arena.formula_automata import LONGEST_BOUND
from fretc.analysis.arena.roles import Roles
from fretc.analysis.findings import RealizabilityVerdict
from fretish.bindings.declarations import Role
from fretish.checking import is_formula


def formula_game(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
) -> tuple[RealizabilityVerdict, str] | None:
    """The verdict of a component and its reason; None: this module cannot decide it.

    The system may force the environment to break an assumption in Spot's game, and may not here.
    So an assumption that reads outputs leaves a component that Spot can win undecided.
    """
    every = [*requirements, *assumptions]
    if not any(is_formula(each.sentence) for each in every) or not spot.is_installed():
        return None
    if not all(_is_propositional(each, roles) for each in every):
        return None
    outputs = {name for each in every for name in each.variables if roles.get(name) is Role.OUTPUT}
    promised = f.and_(*(each.ft_infinite for each in assumptions))
    demanded = f.and_(*(each.ft_infinite for each in requirements))
    if not spot.is_realizable(f.implies(promised, demanded), sorted(outputs)):
        return RealizabilityVerdict.UNREALIZABLE, "the environment wins the game of the formulas"
    if not outputs.isdisjoint(f.atoms(promised)):
        return (
            RealizabilityVerdict.NOT_CHECKED,
            "an assumption reads outputs: the system wins, but perhaps by forcing the environment "
            "to break it",
        )
    return RealizabilityVerdict.REALIZABLE, "the system wins the game of the formulas"


def _is_propositional(requirement: FormalizedRequirement, roles: Roles) -> bool:
    """Whether each atom is a variable with a role, and the formula is short enough for Spot."""
    names = {*f.atoms(requirement.ft_infinite)}
    return (
        names <= {*requirement.variables}
        and not all_comparisons(requirement)
        and all(roles.get(name) in (Role.INPUT, Role.OUTPUT) for name in names)
        and (is_formula(requirement.sentence) or not temporal_predicate(requirement.sentence))
        and requirement.pctl is None
        and f.longest_bound(requirement.ft_infinite) <= LONGEST_BOUND
    )
