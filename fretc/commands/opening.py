"""A project as commands open it: every mistake is printed, and the sound part is worked on.

A mistake refuses the requirements that read it. Whatever else a command prints or makes, its exit
status is then 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fretc.terminal.options import places
from fretc.terminal.output import (
    EXIT_USAGE,
    fail,
    fail_at_end,
    print_diagnostics_below,
    print_project_diagnostics,
    print_status,
)
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from compiler.project.folder import Project
    from fretc.audit.plan import Plan


OF_AUDITS = ("map", "run")
"""The shared tables of the bindings that whatever judges logs reads."""


def project_of(
    files: Sequence[str], requirements: str, bindings: str | None, reads: Collection[str]
) -> tuple[Project, str]:
    """The sound part of a project, and where it is.

    Args:
        files: `.fret` files and folders of such; empty: those of `requirements`.
        requirements: a folder, or one file.
        bindings: their file; None: the one beside the first of them, if any.
        reads: the shared tables of the bindings that the command reads.
    """
    from compiler.project.folder import load
    from compiler.project.paths import listed, requirement_files

    (first, *_) = places(files, requirements)
    paths = listed(files) if files else requirement_files(requirements)
    if isinstance(paths, Diagnostic):
        fail(paths)
    project = load(paths, bindings, reads=reads)
    print_project_diagnostics(project.diagnostics, first)
    return sound_part(project), first


def sound_part(project: Project, *, others: bool = False) -> Project:
    """What no mistake reaches. The mistakes have been printed; what they refuse is listed.

    The command stops where they leave nothing, unless it has something else to do.

    Args:
        project: as it was read.
        others: whether something is made of the bindings alone.
    """
    if has_errors(project.diagnostics):
        fail_at_end()
    sound = project.sound
    if project.refused and not sound.formalized and not (others and project.declarations):
        raise SystemExit(EXIT_USAGE)
    list_mistaken(project)
    return sound


def plan_of(project: Project, requirements: str) -> Plan:
    """The plan to audit what of a project can be judged; all that keeps back the rest is printed.

    Args:
        project: it may have mistakes.
        requirements: where it is, as the user names it.
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
        [each for each in plan.refusals if each not in project.diagnostics], project.diagnostics
    )
    list_refused({each.id: each.why for each in plan.refused}, len(plan.named))
    return plan


def list_mistaken(project: Project) -> None:
    """Print which requirements in force a mistake reaches."""
    refused = {each.requirement.id: each.why for each in project.refused if each.is_in_force}
    list_refused(refused, len(project.requirements))


def list_refused(refused: Mapping[str, Sequence[Diagnostic]], count: int) -> None:
    """Print which requirements are left out: first those of the mistake that reaches the most.

    Args:
        refused: the id of each of them → its mistakes.
        count: of all requirements.
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
    """Its code and its place, as they are printed with it."""
    if why.span is None:
        return why.code.number
    place = why.span.source.name
    if why.span.source.text:
        place += f":{why.span.line}:{why.span.column}"
    return f"{why.code.number} {place}"


def _some(ids: Sequence[str]) -> str:
    more = len(ids) - _MOST_IDS
    return ", ".join(ids[:_MOST_IDS]) + (f" and {more} more" if more > 0 else "")
