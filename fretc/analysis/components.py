"""Components of requirements: linked by shared outputs, or by any shared variable.

Requirements without a common output can be satisfied independently: each component has its own
strategy for the same inputs, and the strategies can be combined.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import Roles
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Role

Tokens = frozenset[str]


def tokens(requirement: FormalizedRequirement, roles: Roles, *kinds: Role) -> Tokens:
    """Variables of these roles that a requirement reads; of what the bindings compute, the signals.

    A variable without a role may have any of them.
    """
    names: set[str] = set()
    for name in requirement.variables:
        if roles.get(name) in (None, *kinds):
            names.update(_read(name, requirement.declarations))
    return frozenset(names)


def _read(name: str, declarations: Declarations | None) -> Iterable[str]:
    """The signals of a proposition or of a computed signal; the name itself for any other."""
    if declarations is not None and name in declarations.propositions:
        return declarations.propositions[name].signals
    if declarations is not None and name in declarations.computed:
        return {each.id for each in e.names(declarations.computed[name].value)}
    return (name,)


def by_outputs(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
) -> list[tuple[FormalizedRequirement, ...]]:
    """Components that share no output; assumptions about outputs join them."""

    def of(requirement: FormalizedRequirement) -> Tokens:
        return tokens(requirement, roles, Role.OUTPUT)

    return _groups(requirements, [assumption for assumption in assumptions if of(assumption)], of)


def by_variables(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
) -> list[tuple[FormalizedRequirement, ...]]:
    """Groups that share no variable."""
    return _groups(
        requirements,
        assumptions,
        lambda requirement: tokens(requirement, roles, Role.INPUT, Role.OUTPUT),
    )


def about(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
) -> tuple[FormalizedRequirement, ...]:
    """Assumptions that concern the requirements, directly or through other assumptions."""
    kinds = (Role.INPUT, Role.OUTPUT)
    reached = {
        token for requirement in requirements for token in tokens(requirement, roles, *kinds)
    }
    rest = list(assumptions)
    found: list[FormalizedRequirement] = []
    while True:
        near = [each for each in rest if reached & tokens(each, roles, *kinds)]
        if not near:
            return tuple(assumption for assumption in assumptions if assumption in found)
        for each in near:
            rest.remove(each)
            found.append(each)
            reached |= tokens(each, roles, *kinds)


def _groups(
    requirements: Sequence[FormalizedRequirement],
    links: Sequence[FormalizedRequirement],
    of: Callable[[FormalizedRequirement], Tokens],
) -> list[tuple[FormalizedRequirement, ...]]:
    """Linked requirements in their order; the links themselves are in no group."""
    groups: list[tuple[set[int], set[str]]] = []
    members = [*requirements, *links]
    for number, requirement in enumerate(members):
        mine = set(of(requirement))
        touched = [group for group in groups if group[1] & mine]
        groups = [group for group in groups if group not in touched]
        numbers = {number}.union(*(group[0] for group in touched))
        groups.append((numbers, mine.union(*(group[1] for group in touched))))
    kept = [sorted(n for n in numbers if n < len(requirements)) for numbers, _ in groups]
    return [tuple(members[n] for n in numbers) for numbers in sorted(filter(None, kept))]


def parts(
    requirements: Sequence[FormalizedRequirement],
    left_out: Collection[str],
    uncertain: Collection[str],
    roles: Roles,
) -> Iterator[tuple[FormalizedRequirement, ...]]:
    """Some requirements of a component that may be decided where the component is not.

    Those that the analysis knows exactly; each of the others by itself, and with each one that
    shares an output. What conflicts in a part conflicts in the component.

    Args:
        requirements: the requirements of the component.
        left_out: ids of those that the problem of the component does not count.
        uncertain: ids of those with atoms that are not known exactly.
        roles: roles of their variables.
    """
    seen: set[tuple[str, ...]] = set()
    doubtful = [each for each in requirements if each.id in left_out or each.id in uncertain]
    exact = tuple(each for each in requirements if each not in doubtful)
    outputs = {each.id: tokens(each, roles, Role.OUTPUT) for each in requirements}
    few = [(each,) for each in doubtful] + [
        (each, other)
        for each in doubtful
        if each.id in left_out
        for other in requirements
        if other is not each and outputs[each.id] & outputs[other.id]
    ]
    for part in (exact, *few):
        ids = tuple(sorted(each.id for each in part))
        if part and len(part) < len(requirements) and ids not in seen:
            seen.add(ids)
            yield part


def without_inputs(
    requirements: Sequence[FormalizedRequirement], roles: Roles
) -> tuple[FormalizedRequirement, ...]:
    """The requirements that the system alone decides."""
    return tuple(each for each in requirements if not tokens(each, roles, Role.INPUT))
