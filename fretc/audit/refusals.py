"""The requirements that an audit cannot judge, and the reasons."""

from __future__ import annotations

from dataclasses import field, replace

from compiler.formalization.binding_agreement import unbound_propositions
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from compiler.targets.python import monitor as monitors
from fretc.audit.evidence.verdict_inputs import VerdictInputs
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.documents import RequirementEntry
from fretish.reading.memory import remembered


@dataclass(frozen=True, slots=True)
class RefusedRequirement:
    """A requirement by which no log can be evaluated: all its results are *no data*."""

    id: str
    sentence: str
    verdict_inputs: VerdictInputs = field(compare=False)
    """The verdict inputs, as of an audited requirement; of the wording as it is if it cannot be
    formalized."""
    why: tuple[Diagnostic, ...]


def refusals(project: Project) -> tuple[tuple[RequirementEntry, tuple[Diagnostic, ...]], ...]:
    """Every requirement in force that an audit cannot judge, with its errors, in order.

    The reasons are errors of the project, and what a log needs in addition: a binding of each
    proposition, a clock, and a monitor.
    """
    requirements = project.in_force
    own = {requirement.entry: requirement for requirement in requirements}
    refused = {each.requirement: each.why for each in project.refused}
    unusable = (
        _unusable(project, requirements[0])
        if requirements and not has_errors(project.general)
        else None
    )
    refused_requirements = []
    for entry in project.requirements:
        requirement = own.get(entry)
        why = [*refused.get(entry, ())]
        if requirement is not None and unusable is not None:
            why.append(unusable)
        elif requirement is not None and project.declarations is not None:
            why.extend(_not_auditable(requirement, project.declarations))
        if why and entry.status != "retired":
            refused_requirements.append((entry, tuple(dict.fromkeys(why))))
    return tuple(refused_requirements)


def _unusable(project: Project, first: FormalizedRequirement) -> Diagnostic | None:
    """The reason why the bindings cannot be used for any requirement; None: they can."""
    declarations = project.declarations
    if declarations is None:
        return diagnostic("no_bindings", first.entry.wording)
    if not declarations.clock.declared:
        return diagnostic(
            "no_clock_declared", declarations.source.span(0, 0), source=declarations.source.name
        )
    return None


def _not_auditable(
    requirement: FormalizedRequirement, declarations: Declarations
) -> tuple[Diagnostic, ...]:
    """The reasons why no log can be evaluated by a requirement; empty: one can."""
    refused = _without_monitor(requirement)
    return (*([refused] if refused else []), *unbound_propositions(requirement, declarations))


@remembered
def _without_monitor(requirement: FormalizedRequirement) -> Diagnostic | None:
    """The reason why there is no monitor of a requirement; None: there is one."""
    return monitors.refuse(replace(requirement, pctl=None))
