"""The requirements that an error in a project affects: those that read the erroneous text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from compiler.formalization.binding_agreement import broken_tables
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project, Refused
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.documents import RequirementEntry


def refused(
    requirements: Sequence[RequirementEntry],
    formalized: Sequence[FormalizedRequirement],
    own: Mapping[RequirementEntry, Diagnostic],
    declarations: Declarations | None,
    unusable: Iterable[Diagnostic],
) -> tuple[Refused, ...]:
    """The requirements with an error in what they read, in order.

    Args:
        requirements: all of them.
        formalized: the formalized ones among them.
        own: the diagnostic of a requirement in its file, by its entry; notes are ignored.
        declarations: the bindings; None if there are none.
        unusable: errors in the parts of the bindings that every requirement reads.
    """
    rule_of = {requirement.entry: requirement for requirement in formalized}
    of_all = [diagnostic for diagnostic in unusable if diagnostic.is_error]
    refusals = []
    for entry in requirements:
        requirement, mistake = rule_of.get(entry), own.get(entry)
        why = [mistake] if mistake is not None and mistake.is_error else []
        if requirement is not None:
            why.extend(of_all)
        if requirement is not None and declarations is not None:
            why.extend(broken_tables(requirement, declarations))
        if why:
            refusals.append(Refused(entry, tuple(dict.fromkeys(why))))
    return tuple(refusals)


def unreviewable(project: Project) -> Mapping[RequirementEntry, tuple[Diagnostic, ...]]:
    """The errors that prevent a trace or a review, by requirement.

    They include the errors of refused requirements. A trace also reads the headers and hazards
    above a requirement, and the accepted warnings.
    """
    errors = {each.requirement: [*each.why] for each in project.refused}
    of_headers = {mistake for each in project.requirements for mistake in each.mistakes}
    tables = project.declarations.mistakes.values() if project.declarations else ()
    of_formulas = {why for each in project.refused for why in each.why} - of_headers
    of_formulas.update(why for mistakes in tables for why in mistakes)
    others = {
        mistake: [each for each in project.requirements if _is_in(mistake, each)]
        for mistake in project.diagnostics
        if mistake.is_error and mistake not in of_formulas
    }
    for requirement in project.requirements if others else ():
        path = _UpwardPath.of(requirement, project)
        reasons = [mistake for mistake, owners in others.items() if path.reads(mistake, owners)]
        errors.setdefault(requirement, []).extend(reasons)
    return {key: tuple(dict.fromkeys(why)) for key, why in errors.items() if why}


_OF_SETTINGS = (Code.BAD_SETTINGS, Code.BAD_ACCEPTANCE)


@dataclass(frozen=True, slots=True)
class _UpwardPath:
    """The path from a requirement up to its hazards."""

    above: Sequence[RequirementEntry]
    """The requirement, and the requirements above it."""
    leaves: bool
    """Whether the path leads to a parent that is not a requirement."""
    is_lost: bool
    """Whether the path leads to an undeclared parent, which may be a requirement whose header
    cannot be read."""

    @classmethod
    def of(cls, requirement: RequirementEntry, project: Project) -> _UpwardPath:
        by_id = {entry.id: entry for entry in project.requirements}
        above, ends = [requirement], set[str]()
        for entry in above:  # it grows while it is walked
            for parent in entry.parents:
                if parent not in by_id:
                    ends.add(parent)
                elif by_id[parent] not in above:
                    above.append(by_id[parent])
        lost = ends - project.hazards.keys() - project.parents.keys()
        return cls(above, bool(ends), bool(lost))

    def reads(self, mistake: Diagnostic, owners: Sequence[RequirementEntry]) -> bool:
        """Whether an error is on the path, or in settings that concern every requirement.

        Args:
            mistake: an error.
            owners: the requirements that contain the error.
        """
        if not owners:
            return self.leaves or mistake.code in _OF_SETTINGS
        of_header = any(mistake in owner.mistakes for owner in owners)
        return (self.is_lost and of_header) or any(owner in self.above for owner in owners)


def _is_in(mistake: Diagnostic, requirement: RequirementEntry) -> bool:
    return mistake in requirement.mistakes or requirement.contains(mistake.span)
