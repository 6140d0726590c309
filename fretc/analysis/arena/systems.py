"""The systems of a requirement set: FRET's components, where one name has several meanings.

A name means the same in all components, as long as it has one role. If a name is an input of one
component and an output of another, or has a role in one of them only, then the components are
different systems. Each is examined by itself, as FRET does.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import Roles, missing_role, role, roles
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class System:
    """Requirements that are examined together, and who chooses their variables."""

    requirements: tuple[FormalizedRequirement, ...]
    assumptions: tuple[FormalizedRequirement, ...]
    roles: Roles


@dataclass(frozen=True, slots=True)
class Systems:
    """The systems of a requirement set, and the errors of their variables."""

    every: tuple[System, ...]
    mistakes: tuple[Diagnostic, ...]
    """F354 for a variable without a role, F907 for one with two."""

    @property
    def can_be_examined(self) -> bool:
        """Whether some requirement reads only variables with a role."""
        return any(
            missing_role(requirement, system.roles) is None
            for system in self.every
            for requirement in system.requirements
        )

    @property
    def roles(self) -> Roles:
        """The role of each variable; `x of A` and `x of B` if it has several."""
        meanings: dict[str, dict[str, Role]] = {}
        for system in self.every:
            for name, own in system.roles.items():
                component = system.requirements[0].sentence.component
                meanings.setdefault(name, {})[component] = own
        known: dict[str, Role] = {}
        for name, by_component in meanings.items():
            if len({*by_component.values()}) == 1:
                known[name] = next(iter(by_component.values()))
            else:
                known |= {f"{name} of {each}": own for each, own in by_component.items()}
        return known


def systems(
    requirements: Sequence[FormalizedRequirement], assumptions: Sequence[FormalizedRequirement]
) -> Systems:
    """All requirements as one system, or each component of FRET as one.

    Args:
        requirements: the requirements.
        assumptions: the assumptions about the environment.
    """
    members: dict[str, list[FormalizedRequirement]] = {}
    for requirement in requirements:
        members.setdefault(requirement.sentence.component, []).append(requirement)
    if not _differ([*requirements, *assumptions]):
        chosen, mistakes = roles([*requirements, *assumptions])
        return Systems((System(tuple(requirements), tuple(assumptions), chosen),), mistakes)
    found: list[System] = []
    wrong: list[Diagnostic] = []
    for own in members.values():
        near = about_same_variables(own, assumptions)
        chosen, mistakes = roles([*own, *near])
        wrong.extend(mistakes)
        found.append(System(tuple(own), near, chosen))
    return Systems(tuple(found), tuple(dict.fromkeys(wrong)))


def about_same_variables(
    requirements: Sequence[FormalizedRequirement], assumptions: Sequence[FormalizedRequirement]
) -> tuple[FormalizedRequirement, ...]:
    """The assumptions for which no name has another role than for the requirements.

    Where a name has another role, it is a variable of another system.
    """
    return tuple(each for each in assumptions if not _differ([*requirements, each]))


def _differ(requirements: Sequence[FormalizedRequirement]) -> bool:
    """Whether a variable has another role in one component than in another."""
    known: dict[str, Role | None] = {}
    return any(
        known.setdefault(name, own) is not own
        for requirement in requirements
        for name in requirement.variables
        for own in [role(requirement, name)]
    )
