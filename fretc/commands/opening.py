"""Load a project: print every error, and continue with the usable requirements.

An error excludes the requirements that depend on it. The exit status of the command is then 2,
whatever else it prints or writes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fretc.terminal.options import places
from fretc.terminal.output import (
    EXIT_USAGE,
    fail,
    fail_at_end,
    or_fail,
    print_diagnostics_below,
    print_project_diagnostics,
    print_status,
)
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, did_you_mean, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.project.project import Project
    from fretc.audit.plan import Plan


AUDIT_TABLES = ("map", "run", "agent")
"""Shared tables of the bindings that commands which evaluate logs read."""


def project_of(
    files: Sequence[str], requirements: str, bindings: str | None, reads: Collection[str]
) -> tuple[Project, str]:
    """The usable part of a project, and its path.

    Args:
        files: `.fret` files and folders; empty: those of `requirements`.
        requirements: a folder, or one file.
        bindings: bindings file; None: the one beside the first requirement file, if any.
        reads: shared tables of the bindings that the command reads.
    """
    from compiler.project.folder import load
    from compiler.project.paths import expanded_paths, requirement_files

    (first, *_) = places(files, requirements)
    paths = or_fail(expanded_paths(files) if files else requirement_files(requirements))
    project = load(paths, bindings, reads=reads)
    print_project_diagnostics(project.diagnostics, first)
    return usable_part(project), first


def usable_part(project: Project, *, others: bool = False) -> Project:
    """The part of a project that no error affects; lists the excluded requirements.

    Exits if nothing is left, unless the bindings alone are enough. The errors have already been
    printed.

    Args:
        project: the whole project.
        others: whether the command can use the bindings alone.
    """
    if has_errors(project.diagnostics):
        fail_at_end()
    sound = project.sound
    if project.refused and not sound.formalized and not (others and project.declarations):
        raise SystemExit(EXIT_USAGE)
    print_requirements_with_errors(project)
    return sound


@dataclass(frozen=True, slots=True)
class RequirementSet:
    """Requirements that are considered together, with assumptions about the environment."""

    project: Project
    requirements: tuple[FormalizedRequirement, ...]
    assumed: tuple[FormalizedRequirement, ...]


def requirement_set(
    files: Sequence[str],
    component: str | None,
    requirements: str,
    bindings: str | None,
    reads: Collection[str],
) -> RequirementSet:
    """The requirements in force; exits if there is none, or an assumption has an error.

    Args: as for `project_of`; and `component`, whose requirements are chosen (None: all).
    """
    from fretc.analysis.arena.systems import about_same_variables
    from fretc.analysis.assumptions import assumptions, guarantees

    project, first = project_of(files, requirements, bindings, reads)
    chosen = guarantees(active_requirements(project, component))
    if not chosen:
        fail(diagnostic("nothing_to_analyze"))
    assumed, remarks = assumptions(project.in_force, project.declarations)
    if component is not None:
        assumed = about_same_variables(chosen, assumed)
    print_project_diagnostics(remarks, first)
    if has_errors(remarks):
        raise SystemExit(EXIT_USAGE)
    return RequirementSet(project, chosen, assumed)


def active_requirements(
    project: Project, component: str | None
) -> tuple[FormalizedRequirement, ...]:
    """The requirements in force: all, or those of one component."""
    requirements = project.in_force
    if component is not None:
        requirements = _of_component(requirements, component)
    if not requirements:
        fail(diagnostic("nothing_to_analyze"))
    return requirements


def _of_component(
    requirements: Sequence[FormalizedRequirement], component: str
) -> tuple[FormalizedRequirement, ...]:
    chosen = tuple(
        requirement for requirement in requirements if requirement.sentence.component == component
    )
    if not chosen:
        known = tuple(dict.fromkeys(requirement.sentence.component for requirement in requirements))
        fail(
            diagnostic(
                "unknown_component",
                component=component,
                help=did_you_mean(component, known, f"there are {', '.join(known)}"),
            )
        )
    return chosen


def planned_project(requirements: str, bindings: str | None) -> tuple[Project, Plan]:
    """The project, and the audit plan for its usable requirements."""
    from compiler.project.folder import load
    from compiler.project.paths import requirement_files

    files = or_fail(requirement_files(requirements))
    project = load(files, bindings, reads=AUDIT_TABLES)
    return project, plan_of(project, requirements)


def input_files(project: Project, *others: str | None) -> list[str]:
    """The files of a project, and other inputs that are given: no output may replace them."""
    from compiler.project.paths import companions

    sources = [requirement.wording.source.name for requirement in project.requirements]
    return [*sources, *companions(sources), *(name for name in others if name is not None)]


def plan_of(project: Project, requirements: str) -> Plan:
    """Audit plan for the usable requirements; prints why the others are excluded.

    Args:
        project: the project, which may have errors.
        requirements: its path, as named by the user.
    """
    from fretc.audit.plan import Plan, planned

    print_project_diagnostics(project.diagnostics, requirements)
    if has_errors(project.diagnostics):
        fail_at_end()
    plan = planned(project)
    if not isinstance(plan, Plan):
        fail(*(reason for reason in plan if reason not in project.diagnostics))
    if plan.refused:
        fail_at_end()
    print_diagnostics_below(
        [refusal for refusal in plan.refusals if refusal not in project.diagnostics],
        project.diagnostics,
    )
    print_excluded({refusal.id: refusal.why for refusal in plan.refused}, len(plan.named))
    return plan


def print_requirements_with_errors(project: Project) -> None:
    """Print which active requirements have errors."""
    refused = {
        refusal.requirement.id: refusal.why for refusal in project.refused if refusal.is_in_force
    }
    print_excluded(refused, len(project.requirements))


def print_excluded(refused: Mapping[str, Sequence[Diagnostic]], count: int) -> None:
    """Print which requirements are left out, the most frequent error first.

    Args:
        refused: id of each excluded requirement → its errors.
        count: number of all requirements.
    """
    if not refused:
        return
    ids: dict[str, list[str]] = {}
    for id, why in refused.items():
        ids.setdefault(_where(why[0]), []).append(id)
    worst = sorted(ids, key=lambda where: -len(ids[where]))[:_MOST_LINES]
    width = max(map(len, worst))
    noun = "requirement" if count == 1 else "requirements"
    lines = [f"left out because of errors: {len(refused)} of {count} {noun}"]
    lines += [f"  {where:<{width}}  {_some(ids[where])}" for where in worst]
    if len(ids) > _MOST_LINES:
        lines.append(f"  and the requirements of {len(ids) - _MOST_LINES} more errors")
    print_status("\n" + "\n".join(map(visible, lines)))


_MOST_LINES, _MOST_IDS = 20, 8


def _where(why: Diagnostic) -> str:
    """Code and position of a diagnostic, as they are printed with it."""
    if why.span is None:
        return why.code.number
    location = why.span.source.name
    if why.span.source.text:
        location += f":{why.span.line}:{why.span.column}"
    return f"{why.code.number} {location}"


def _some(ids: Sequence[str]) -> str:
    more = len(ids) - _MOST_IDS
    return ", ".join(ids[:_MOST_IDS]) + (f" and {more} more" if more > 0 else "")
