"""The requirements that an audit cannot judge, and the reasons."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from compiler.formalization.binding_agreement import unbound
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.folder import Project
from compiler.targets.python import monitor as monitors
from fretc.audit.evidence.basis import Basis
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.documents import Requirement


@dataclass(frozen=True, slots=True)
class RefusedRequirement:
    """A requirement that no log can be judged by: it is in every result, and never satisfied."""

    id: str
    sentence: str
    basis: Basis = field(compare=False)
    """As that of a claim; of the wording as it is, where that cannot be formalized."""
    why: tuple[Diagnostic, ...]


def refusals(project: Project) -> tuple[tuple[Requirement, tuple[Diagnostic, ...]], ...]:
    """Every requirement in force that an audit cannot judge, and why: errors, in their order.

    Those of the project, and what a log needs beside: a binding of each proposition, a clock, and
    a monitor.
    """
    rules = active_requirements(project)
    own = {id(rule.requirement): rule for rule in rules}
    refused = {id(each.requirement): each.why for each in project.refused}
    unusable = _unusable(project, rules[0]) if rules and not has_errors(project.general) else None
    found = []
    for requirement in project.requirements:
        rule = own.get(id(requirement))
        why = [*refused.get(id(requirement), ())]
        if rule is not None and unusable is not None:
            why.append(unusable)
        elif rule is not None and project.declarations is not None:
            why.extend(_not_auditable(rule, project.declarations))
        if why and requirement.status != "retired":
            found.append((requirement, tuple(dict.fromkeys(why))))
    return tuple(found)


def active_requirements(project: Project) -> list[FormalizedRequirement]:
    """The rules of all requirements that are not retired."""
    return [rule for rule in project.rules if rule.requirement.status != "retired"]


def _unusable(project: Project, first: FormalizedRequirement) -> Diagnostic | None:
    """Why the bindings cannot be used for any requirement, given once; None where they can."""
    declarations = project.declarations
    if declarations is None:
        return Diagnostic(
            Code.UNBOUND,
            "no bindings say what the propositions mean in the messages",
            first.requirement.wording,
            help="write `bindings.toml` beside the requirements, or name it with `--bindings`",
        )
    if not declarations.clock.declared:
        return Diagnostic(
            Code.NO_CLOCK,
            f"`{declarations.source.name}` declares no clock",
            declarations.source.span(0, 0),
            help='add `[clock]` with `tick = "100 ms"`',
        )
    return None


def _not_auditable(
    rule: FormalizedRequirement, declarations: Declarations
) -> tuple[Diagnostic, ...]:
    """Why no log can be judged by a rule; empty where one can."""
    refused = monitors.refuse(replace(rule, pctl=None))
    return (*([refused] if refused else []), *unbound(rule, declarations))
