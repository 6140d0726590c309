"""What a mistake in a project reaches: the requirements that read it, and no others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from compiler.formalization.binding_agreement import broken_tables
from compiler.formalization.formalized import Formalized
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.documents import Requirement

if TYPE_CHECKING:
    from compiler.project.folder import Project


@dataclass(frozen=True, slots=True)
class Refused:
    """A requirement that nothing can be made of, and the mistakes in what it reads."""

    requirement: Requirement
    why: tuple[Diagnostic, ...]
    """Errors: in its header, its sentence, its id, and the bindings of its names."""

    @property
    def is_in_force(self) -> bool:
        """Whether anybody misses it."""
        return self.requirement.status != "retired"


def refused(
    requirements: Sequence[Requirement],
    rules: Sequence[Formalized],
    own: Mapping[int, Diagnostic],
    declarations: Declarations | None,
    unusable: Iterable[Diagnostic],
) -> tuple[Refused, ...]:
    """The requirements that some mistake reaches, in their order.

    Args:
        requirements: all of them.
        rules: those that could be formalized.
        own: the mistake of a requirement in its file, by its `id()`; a note is none.
        declarations: the bindings; None where there are none.
        unusable: mistakes in the bindings that every requirement reads.
    """
    rule_of = {id(rule.requirement): rule for rule in rules}
    of_all = [each for each in unusable if each.is_error]
    found = []
    for requirement in requirements:
        rule, mistake = rule_of.get(id(requirement)), own.get(id(requirement))
        why = [mistake] if mistake is not None and mistake.is_error else []
        if rule is not None:
            why.extend(of_all)
        if rule is not None and declarations is not None:
            why.extend(broken_tables(rule, declarations))
        if why:
            found.append(Refused(requirement, tuple(dict.fromkeys(why))))
    return tuple(found)


def unreviewable(project: Project) -> Mapping[int, tuple[Diagnostic, ...]]:
    """The requirements whose chain up to the hazards a mistake reaches, by their `id()`.

    Beside those that nothing can be made of: whoever is to trace, review or compare a requirement
    reads what is above it, and the warnings that are accepted.
    """
    found = {id(each.requirement): [*each.why] for each in project.refused}
    known = {why for each in project.refused for why in each.why}
    tables = project.declarations.mistakes.values() if project.declarations else ()
    known.update(why for mistakes in tables for why in mistakes)
    ways = _Ways(project.requirements)
    for mistake in project.diagnostics:
        if mistake.is_error and mistake not in known:
            for requirement in project.requirements:
                if ways.read(requirement, mistake):
                    found.setdefault(id(requirement), []).append(mistake)
    return {key: tuple(dict.fromkeys(why)) for key, why in found.items()}


_OF_SETTINGS = (Code.BAD_SETTINGS, Code.BAD_ACCEPTANCE)


class _Ways:
    """The ways from requirements up to what they are there for."""

    def __init__(self, requirements: Sequence[Requirement]) -> None:
        self._by_id = {each.id: each for each in requirements}
        self._known: dict[str, tuple[list[Requirement], bool]] = {}

    def read(self, requirement: Requirement, mistake: Diagnostic) -> bool:
        """Whether the mistake is in the requirement, above it, or in the settings of all."""
        above, leaves = self._above(requirement)
        if any(each.contains(mistake.span) for each in self._by_id.values()):
            return any(each.contains(mistake.span) for each in above)
        return leaves or mistake.code in _OF_SETTINGS

    def _above(self, requirement: Requirement) -> tuple[list[Requirement], bool]:
        """It and the requirements above it; and whether the way leads to anything else."""
        if requirement.id not in self._known:
            waiting, leaves = [requirement], False
            for each in waiting:  # it grows while it is walked
                for parent in each.parents:
                    above = self._by_id.get(parent)
                    leaves = leaves or above is None
                    if above is not None and above not in waiting:
                        waiting.append(above)
            self._known[requirement.id] = waiting, leaves
        return self._known[requirement.id]
