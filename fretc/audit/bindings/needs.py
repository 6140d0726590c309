"""What the requirements need of the bindings, and the bindings do not have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.formalization import binding_agreement
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.declarations import Declarations, Role
from fretish.checking import conditions
from fretish.classes.frozen import dataclass
from fretish.clock import NANOSECONDS


@dataclass(frozen=True, slots=True)
class MissingProposition:
    """A proposition that requirements use and no bindings define."""

    name: str
    requirements: tuple[str, ...]
    role: str
    aggregate: str


@dataclass(frozen=True, slots=True)
class MissingSignal:
    """A signal that comparisons of the requirements use and no bindings declare."""

    name: str
    requirements: tuple[str, ...]
    words: tuple[str, ...] = ()
    """The texts with which it is compared."""
    units: tuple[str, ...] = ()
    """The units of the numbers with which it is compared."""


def missing_propositions(project: Project) -> tuple[MissingProposition, ...]:
    """The propositions of the requirements that the project's bindings do not define.

    Bindings with a mistake are those that the draft is to replace: they define none.
    """
    declared = project.declarations
    defined = declared.propositions if declared and not declared.mistakes else {}
    users: dict[str, list[FormalizedRequirement]] = {}
    for requirement in project.in_force:
        for name in requirement.watched:
            if name not in defined and not _unread(requirement, name, declared):
                users.setdefault(name, []).append(requirement)
    return tuple(_missing_proposition(name, requirements) for name, requirements in users.items())


def missing_signals(project: Project) -> tuple[MissingSignal, ...]:
    """The undeclared signals in comparisons of the requirements."""
    users: dict[str, dict[str, FormalizedRequirement]] = {}
    for requirement in project.in_force:
        for name in requirement.watched:
            for signal in _unread(requirement, name, project.declarations):
                users.setdefault(signal, {})[requirement.id] = requirement
    return tuple(_missing_signal(name, by_id) for name, by_id in users.items())


def _missing_signal(name: str, users: Mapping[str, FormalizedRequirement]) -> MissingSignal:
    words: dict[str, None] = {}
    units: dict[str, None] = {}
    comparisons = (
        part
        for requirement in users.values()
        for condition in conditions(requirement.written)
        for part in e.parts(condition)
        if isinstance(part, e.Comparison)
    )
    for each in comparisons:
        left, right = each.left, each.right
        if isinstance(left, e.Name) and left.id == name and isinstance(right, e.Name | e.Word):
            words[right.id if isinstance(right, e.Name) else right.text] = None
        if any(part.id == name for part in e.names(each)):
            units |= {part.unit: None for part in e.parts(each) if isinstance(part, e.Quantity)}
    return MissingSignal(name, tuple(users), tuple(words), tuple(units))


def _unread(
    requirement: FormalizedRequirement, name: str, declared: Declarations | None
) -> tuple[str, ...]:
    """The undeclared signals in the comparison of a proposition; none if bindings define it."""
    if declared is not None and name in declared.propositions:
        return ()
    return binding_agreement.missing_signals(
        requirement, name, declared.measured if declared else {}
    )


def durations(project: Project) -> tuple[int, ...]:
    """The durations of the requirements in nanoseconds, without those stated in ticks."""
    seconds_or_ticks = [
        s.duration(requirement.sentence.timing) for requirement in project.formalized
    ]
    return tuple(
        d.amount * NANOSECONDS[d.unit] for d in seconds_or_ticks if d and d.unit in NANOSECONDS
    )


def _missing_proposition(
    name: str, requirements: Sequence[FormalizedRequirement]
) -> MissingProposition:
    roles = {_role(name, requirement.sentence) for requirement in requirements}
    role = roles.pop() if len(roles) == 1 else Role.INTERNAL
    aggregate = "any" if role is Role.INPUT else "last"
    return MissingProposition(
        name, tuple(requirement.id for requirement in requirements), str(role), aggregate
    )


def _role(name: str, sentence: s.Sentence) -> Role:
    """The role of a name, from its place in the sentence."""

    def within(expression: e.Expression | None) -> bool:
        return expression is not None and any(part.id == name for part in e.names(expression))

    if within(sentence.response):
        return Role.OUTPUT
    if within(sentence.condition.expression if sentence.condition else None):
        return Role.INPUT
    if within(sentence.scope.mode if sentence.scope else None):
        return Role.MODE
    return Role.INTERNAL
