"""`fretc play`: make an HTML page on which traces can be edited."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import active_requirements, input_files, project_of
from fretc.terminal.options import (
    analysis_option,
    files_argument,
    first_bindings_option,
    output_option,
    path_option,
    requirements_option,
    tests_option,
)
from fretc.terminal.output import (
    EXIT_OK,
    EXIT_USAGE,
    fail,
    or_fail,
    print_diagnostics,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.project.project import Project
    from fretc.play.recorded import Recorded
    from fretc.play.starts import Start
    from fretc.play.versions import Side


_SECONDS = 20
"""CPU seconds for the search of a trace that distinguishes two versions."""


@click.command()
@files_argument
@requirements_option
@first_bindings_option
@path_option(
    "--against",
    metavar="OLD",
    help="Earlier version of the requirements, a file or folder. The page shows both versions, "
    "the ticks at which their verdicts differ, and a shortest trace that distinguishes "
    "them.",
)
@path_option(
    "--log",
    "logs",
    multiple=True,
    help="Recorded run whose violations are added as traces. Repeatable.",
)
@tests_option
@analysis_option
@output_option(default="build/play.html", show_default=True, help="HTML page. `-` prints it.")
def play(
    files: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    against: str | None,
    logs: tuple[str, ...],
    tests: str | None,
    analysis: str | None,
    output: str,
) -> None:
    """Make an HTML page on which you edit a trace and see each requirement's verdict.

    FILE is a requirement file, or a folder of them; it replaces `--requirements`. The page is
    one file, needs no network, and runs the monitors of `--emit js`. It starts with the traces
    of `fretc explain` and, if they exist, those of `fretc test` and `fretc analyze`.

    Exit status: 0 the page has all requirements, 2 bad usage or bad input, or no monitor can be
    made for a requirement, which the page names.

    Example: fretc play requirements/ --log run.mcap
    """
    from compiler.formalization.formalize import name_collisions
    from fretc.play.page import html
    from fretc.play.starts import of_examples
    from fretc.play.versions import Versions, side_by_side, versions

    project, _ = project_of(files, requirements, bindings, ("environment",))
    now, refusals = _side(project)
    known = now.requirements
    if not known:
        fail(*refusals)
    earlier = (
        project_of((against,), requirements, bindings, ("environment",))[0]
        if against is not None
        else None
    )
    changes = versions(now, _side(earlier)[0], _SECONDS) if earlier else Versions()
    shown = [*side_by_side(changes, known)]
    clashing = [*name_collisions(shown)]
    if clashing:
        fail(*clashing)
    print_diagnostics(refusals)
    recorded = [*_recorded(project, known, logs)]
    starts = [
        *(start for run in recorded for start in run.starts),
        *filter(None, [pair.start for pair in changes.pairs]),
        *of_examples(known),
        *of_files(project.formalized, known, tests, analysis),
    ]
    notes = [*(pair.note for pair in changes.pairs), *changes.notes]
    notes += [note for run in recorded for note in run.notes]
    before = {pair.new.id: pair.old.id for pair in changes.pairs}
    page = html(shown, [*now.refused.items()], starts, before, notes)
    inputs = input_files(project, bindings, tests, analysis, *logs)
    write_outputs({Path(output): page}, [*inputs, *(input_files(earlier) if earlier else [])])
    raise SystemExit(EXIT_USAGE if refusals else EXIT_OK)


def _side(project: Project) -> tuple[Side, list[Diagnostic]]:
    """One version of a project, and why some requirements without errors have no monitor."""
    from fretc.play.versions import side

    mistaken = (refusal for refusal in project.refused if refusal.is_in_force)
    return side(active_requirements(project, None), mistaken, project.declarations)


def _recorded(
    project: Project, known: Sequence[FormalizedRequirement], logs: Sequence[str]
) -> Iterator[Recorded]:
    """Traces from logs; exits if a log cannot be read or evaluated."""
    from fretc.audit.plan import Plan, planned
    from fretc.play.recorded import of_log

    if not logs:
        return
    plan = planned(project)
    if not isinstance(plan, Plan):
        fail(*plan)
    print_diagnostics([*plan.refusals])
    for log in logs:
        starts = or_fail(of_log(known, plan, log))
        print_diagnostics(starts.findings)
        yield starts


def of_files(
    requirements: Sequence[FormalizedRequirement],
    known: Sequence[FormalizedRequirement],
    tests: str | None,
    analysis: str | None,
) -> Iterator[Start]:
    """Results of other commands, as far as they are about the present requirements."""
    from fretc.analysis.evidence import default_path
    from fretc.analysis.evidence import read as read_analysis
    from fretc.play.starts import changed, of_analysis, of_suite, others, stale
    from fretc.testing.reader import DEFAULT
    from fretc.testing.reader import read as read_suite

    path = tests or (DEFAULT if Path(DEFAULT).exists() else None)
    if path is not None:
        suite = or_fail(read_suite(path))
        old = changed(suite, requirements)
        if old:
            print_diagnostics([stale(path, f"{', '.join(old)} changed since", "fretc test")])
        yield from of_suite(suite, known)
    path = analysis or default_path()
    if path is not None:
        found = or_fail(read_analysis(path)).document
        old = others(found, requirements)
        if old:
            print_diagnostics([stale(path, f"{', '.join(old)} changed since", "fretc analyze")])
        yield from of_analysis(found, old)
