"""`fretc bind`: draft bindings from a log, or check bindings against logs."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import AUDIT_TABLES, print_requirements_with_errors
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    bindings_option,
    extras,
    format_option,
    is_given,
    jobs_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    coloured,
    fail,
    fail_at_end,
    or_fail,
    print_diagnostics,
    print_project_diagnostics,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from compiler.project.project import Project


@click.command(
    epilog=extras(LOG_EXTRAS),
)
@click.argument("paths", nargs=-1, type=PATH, metavar="[LOG...]")
@path_option("--from", "source", metavar="LOG", help="Draft bindings from this log.")
@click.option("--check", is_flag=True, help="Check the bindings against each LOG.")
@requirements_option
@bindings_option
@output_option(default="-", show_default=True, help="File for the draft.")
@click.option("--update", is_flag=True, help="Add to the bindings what `--from LOG` would draft.")
@click.option("--force", is_flag=True, help="Overwrite an existing file.")
@format_option(text="Output format of `--check`.")
@jobs_option
def bind(
    paths: tuple[str, ...],
    source: str | None,
    check: bool,
    requirements: str,
    bindings: str | None,
    output: str,
    update: bool,
    force: bool,
    output_format: str,
    jobs: int,
) -> None:
    """Draft bindings from a log, or check bindings against logs.

    `--from LOG` prints a bindings.toml with the clock, a signal for each field whose meaning is
    known, all other numbers and texts as comments, and a blank entry for each proposition that
    the requirements use and no bindings define.

    `--from LOG --update` appends to the existing bindings a table for each name that the
    requirements use and the bindings lack. It changes nothing that is there.

    `--check LOG...` prints in how many ticks each proposition was true, false and unknown, and
    how often it changed. Exit status: 0 each proposition took both values in some log, 3 one
    did not, 2 bad usage or bad input.

    Example: fretc bind --from run.mcap -o requirements/bindings.toml
    """
    drafts = source is not None
    if drafts == check or (update and not drafts):
        fail(_not_one_mode())
    if source is not None and update:
        _update(source, requirements, bindings)
    elif source is not None:
        if paths:
            fail(_second_log(paths[0]))
        project = _project(requirements, bindings, replaced=output)
        print_diagnostics(
            [
                finding
                for finding in project.diagnostics
                if finding.is_error and not _is_in(finding, output)
            ]
        )
        _draft(source, project, output, force=force)
    elif not paths:
        fail(diagnostic("no_log_to_check"))
    else:
        project = _project(requirements, bindings)
        _check(paths, project, requirements, output_format, jobs)


def _project(requirements: str, bindings: str | None, replaced: str | None = None) -> Project:
    """The requirements and their bindings. Errors make the command exit with 2 at its end.

    The command stops if no part of the bindings can be used. Requirements may be missing, unless
    the user names their path.

    Args:
        requirements: a folder or a file.
        bindings: bindings file; None: the one beside the requirements, if any.
        replaced: file that the command will write; errors in its present content do not count.
    """
    from compiler.project.folder import load
    from compiler.project.paths import requirement_files, sibling_path

    files = requirement_files(requirements)
    if isinstance(files, Diagnostic):
        if is_given("requirements"):
            fail(files)
        files = []
    file = bindings or sibling_path(requirements, "bindings.toml")
    project = load(files, file, reads=AUDIT_TABLES)
    relevant = [d for d in project.diagnostics if replaced is None or not _is_in(d, replaced)]
    if has_errors(relevant):
        fail_at_end()
    if has_errors(each for each in project.general if each in relevant):
        fail(*relevant)
    return project


def _is_in(diagnostic: Diagnostic, path: str) -> bool:
    """Whether the diagnostic is about this file."""
    span = diagnostic.span
    return span is not None and os.path.realpath(span.source.name) == os.path.realpath(path)


# Drafts --------------------------------------------------------------------------------------


def _draft(log: str, project: Project, output: str, *, force: bool) -> None:
    from fretc.audit.bindings.draft import draft
    from fretc.audit.bindings.needs import durations, missing_propositions, missing_signals
    from fretc.logs.reader import look

    if output != "-" and not force and os.path.lexists(output):
        fail(diagnostic("bindings_exist", path=output))
    contents = or_fail(look(log, words=True))
    print_diagnostics(contents.recording.findings)
    text = draft(
        contents, missing_propositions(project), durations(project), missing_signals(project)
    )
    write_outputs({Path(output): text}, (log,))
    raise SystemExit(EXIT_OK)


def _update(log: str, requirements: str, bindings: str | None) -> None:
    from compiler.project.paths import sibling_path
    from fretc.audit.bindings.draft import addition
    from fretc.audit.bindings.needs import missing_propositions, missing_signals
    from fretc.logs.reader import look

    file = bindings or sibling_path(requirements, "bindings.toml")
    project = _project(requirements, file)
    declared = project.declarations
    if file is None or declared is None:
        fail(diagnostic("no_bindings_to_update"))
    known = {*declared.measured, *declared.propositions, *(name for _, name in declared.mistakes)}
    propositions = [each for each in missing_propositions(project) if each.name not in known]
    signals = [each for each in missing_signals(project) if each.name not in known]
    if not propositions and not signals:
        click.echo("nothing to add: the bindings have every name of the requirements", err=True)
        raise SystemExit(EXIT_OK)
    contents = or_fail(look(log, words=True))
    print_diagnostics(contents.recording.findings)
    text = declared.source.text.rstrip("\n") + "\n" + addition(contents, propositions, signals)
    write_outputs({Path(file): text}, (log,))
    raise SystemExit(EXIT_OK)


def _not_one_mode() -> Diagnostic:
    """F907: neither `--from` nor `--check`, or both."""
    return diagnostic("from_or_check")


def _second_log(path: str) -> Diagnostic:
    """F907: a LOG in addition to that of `--from`."""
    return diagnostic("second_log", path=path)


# Checks --------------------------------------------------------------------------------------


def _check(
    paths: tuple[str, ...], project: Project, requirements: str, output_format: str, jobs: int
) -> None:
    from fretc.audit.bindings.coverage import coverage
    from fretc.audit.log_paths import logs as logs_of
    from fretc.audit.plan import Plan, planned

    logs = or_fail(logs_of(paths))
    if project.declarations is None:
        fail(_no_bindings())
    # Bindings can be checked even if no requirement can be audited.
    plan = planned(project)
    result = coverage(project.declarations, logs, jobs, plan if isinstance(plan, Plan) else None)
    if isinstance(result, Diagnostic):
        fail(
            *([diagnostic for diagnostic in project.diagnostics if diagnostic.is_error] or [result])
        )
    unbound = [each for each in _unbound(project) if each not in project.diagnostics]
    diagnostics = [*unbound, *project.diagnostics, *project.answered(result.diagnostics)]
    print_project_diagnostics(diagnostics, requirements)
    print_requirements_with_errors(project)
    click.echo(result.as_json if output_format == "json" else coloured(result.text), nl=False)
    raise SystemExit(
        EXIT_USAGE if has_errors(diagnostics) else EXIT_OK if result.shown else EXIT_INCONCLUSIVE
    )


def _unbound(project: Project) -> list[Diagnostic]:
    """A diagnostic for each proposition that a requirement names and the bindings do not define.

    Retired requirements are skipped, because no audit evaluates them.
    """
    from compiler.formalization.binding_agreement import unbound_propositions

    assert project.declarations is not None
    return [
        missing
        for requirement in project.in_force
        for missing in unbound_propositions(requirement, project.declarations)
    ]


def _no_bindings() -> Diagnostic:
    return diagnostic("no_bindings_to_check")
