"""`fretc check`: report errors and warnings of a project, before any run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from fretc.terminal.options import (
    analysis_option,
    bindings_option,
    evidence_option,
    evidence_path,
    extras,
    format_option,
    hazards_option,
    is_given,
    requirements_option,
    verification_option,
)
from fretc.terminal.output import (
    EVIDENCE,
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    STORE,
    or_fail,
    print_diagnostic_groups,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.rendering import as_json, visible

if TYPE_CHECKING:
    from compiler.project.project import Project
    from fretc.analysis.evidence import AnalyzedSet
    from fretish.documents import RequirementEntry


@click.command(
    epilog=extras({"reqif": "parents in a .reqif"}),
)
@requirements_option
@bindings_option
@hazards_option
@evidence_option
@verification_option
@analysis_option
@click.option(
    "--analyze",
    is_flag=True,
    help="Also find out whether all requirements can be satisfied together. An up-to-date "
    "result of `fretc analyze` is used again.",
)
@click.option(
    "--fix",
    is_flag=True,
    help="First apply the safe fixes to the requirement files, such as "
    "`shall` for `should`. Each fix is listed.",
)
@click.option(
    "--watch",
    is_flag=True,
    help="Check again after each change of a file, until Ctrl-C. The exit status is that of the "
    "last check.",
)
@format_option()
def check(
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str | None,
    verification: str | None,
    analysis: str | None,
    analyze: bool,
    fix: bool,
    watch: bool,
    output_format: str,
) -> None:
    """Report errors and warnings of a project, before any run.

    It checks requirements, bindings, hazards, lock and waivers, and reports: syntax errors;
    whatever an audit would refuse; numbers that differ between a sentence and the parameters;
    requirements that always hold; methods in the hazards that can give no result; missing
    links; changes since the review or the audit; reviewed requirements that are gone; waivers
    that match nothing. Accepted warnings are listed with their reasons.

    Exit status: 0 no warnings, or only accepted ones; 3 warnings; 2 errors.

    Example: fretc check --fix
    """
    from compiler.project.folder import load_folder
    from fretc.checking.diagnostics import SideFiles, project_diagnostics

    if watch and output_format == "json":
        raise click.UsageError("--watch cannot be combined with --format json")
    if fix:
        _fix(requirements)
    named = is_given("evidence")

    def once() -> NoReturn:
        project = or_fail(load_folder(requirements, bindings, hazards))
        files = SideFiles(requirements, evidence_path(evidence), verification, analysis, named)
        together = _together if analyze else None
        _finish(project_diagnostics(project, files, together), project.requirements, output_format)

    if watch:
        _again_and_again(once, requirements, (bindings, hazards, evidence, verification, analysis))
    once()


_PAUSE = 0.3
"""Seconds between two looks at the files."""


def _again_and_again(
    once: Callable[[], NoReturn], requirements: str, named: Sequence[str | None]
) -> NoReturn:
    """Check after each change, and exit with the status of the last check when Ctrl-C comes.

    Args:
        once: checks the present files, prints the result and exits.
        requirements: the folder of the requirements.
        named: the other files that the user names.
    """
    from fretc.analysis.evidence import DEFAULT as ANALYSIS
    from fretc.checking.inputs import stamps
    from fretc.verification.reader import DEFAULT as VERIFICATION
    from fretish.reading.limits import ExceededError, exceeded
    from fretish.reading.memory import Memory

    beside = (*named, EVIDENCE, STORE, VERIFICATION, ANALYSIS)
    memory, status = Memory(), EXIT_OK
    before: frozenset[object] | None = None
    try:
        while True:
            present = stamps(requirements, beside)
            if present != before:
                before = present
                click.clear()  # of a terminal only
                try:
                    with memory.active():
                        once()
                except SystemExit as exit_:
                    status = int(exit_.code or EXIT_OK)
                except ExceededError as error:
                    print_diagnostics([exceeded(error)])
                    status = EXIT_USAGE
                print_status(visible(f"waiting for a change of {requirements}; Ctrl-C ends"))
                print_status("")
            time.sleep(_PAUSE)
    except KeyboardInterrupt:
        raise SystemExit(status) from None


def _together(project: Project, known: AnalyzedSet | None) -> Iterator[Diagnostic]:
    """F561 for each conflict, F562 if realizability is unknown."""
    from fretc.analysis.analysis import DEFAULT
    from fretc.analysis.arena.systems import systems
    from fretc.analysis.assumptions import assumptions, guarantees
    from fretc.analysis.evidence import remarks, suspicions
    from fretc.commands.analyze import asked

    requirements = guarantees(project.in_force)
    assumed, said = assumptions(project.in_force, project.declarations)
    yield from said
    examined = systems(requirements, assumed)
    yield from examined.mistakes
    if requirements and not has_errors(said):
        if known is not None and not [*suspicions(known.document, requirements, assumed)]:
            analysis = known.document.analysis
        else:
            analysis, _ = asked(requirements, assumed, examined, DEFAULT)
        yield from remarks(analysis, requirements)


def _fix(folder: str) -> None:
    """Apply the safe fixes to all files or to none, and list each fix."""
    from compiler.project.fixes import fixed_files
    from compiler.project.paths import requirement_files

    paths = requirement_files(folder)
    files = () if isinstance(paths, Diagnostic) else fixed_files(paths)
    write_outputs({Path(file.path): file.text for file in files})
    for fix in (fix for file in files for fix in file.fixes):
        location = f"{fix.span.source.name}:{fix.span.line}:{fix.span.column}"
        print_status(visible(f"fixed {location}: {fix.change}"))
    if files:
        print_status("")


def _finish(
    diagnostics: tuple[Diagnostic, ...],
    requirements: Sequence[RequirementEntry],
    output_format: str,
) -> NoReturn:
    """Print the diagnostics and exit with the matching status."""
    from compiler.files.templating import to_json

    assumed = [each.id for each in requirements if each.is_assumption and each.is_in_force]
    accepted = [d for d in diagnostics if d.accepted]
    errors = sum(d.is_error for d in diagnostics)
    warnings = sum(d.is_open for d in diagnostics)
    if output_format == "json":
        counts: dict[str, object] = {
            "requirements": len(requirements),
            "assumptions": assumed,
            "mistakes": errors,
            "warnings": warnings,
            "accepted": len(accepted),
        }
        click.echo(to_json({**counts, "diagnostics": [as_json(d) for d in diagnostics]}))
    else:
        print_diagnostic_groups([d for d in diagnostics if not d.accepted], accepted)
        if diagnostics:
            print_status("")
        if assumed:
            print_status(visible(f"assumptions about the environment: {', '.join(assumed)}"))
        counts_in_words = f"{_many(errors, 'error')}, {_many(warnings, 'warning')}"
        also = f", {len(accepted)} accepted" if accepted else ""
        print_status(f"{_many(len(requirements), 'requirement')}: {counts_in_words}{also}")
    raise SystemExit(EXIT_USAGE if errors else EXIT_INCONCLUSIVE if warnings else EXIT_OK)


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
