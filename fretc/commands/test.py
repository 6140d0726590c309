"""`fretc test`: generate short test traces from requirements, or test a program.

`test_suite` generates the tests, and `test_against` tests a program; this module reads the options.
"""

from __future__ import annotations

from typing import Any

import click

from fretc.commands.opening import AUDIT_TABLES, input_files, requirement_set
from fretc.terminal.options import (
    SECONDS,
    component_option,
    extras,
    files_argument,
    first_bindings_option,
    format_option,
    grouped,
    jobs_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import fail
from fretish.diagnostics.diagnostic import did_you_mean
from fretish.diagnostics.messages import diagnostic


@click.command(
    epilog=extras({"sim": "--emit mcap and --emit scenario"}),
)
@files_argument
@component_option
@click.option("--show", metavar="ID", help="Print the tests of this requirement, tick by tick.")
@path_option("--suite", "saved", help="Use the tests of this file instead of generating new ones.")
@click.option(
    "--time",
    "seconds",
    type=SECONDS,
    default=120,
    show_default=True,
    help="CPU time limit for each requirement, in seconds.",
)
@click.option(
    "--emit",
    "emitted",
    type=click.Choice(("pytest", "csv", "fret", "c", "java", "mcap", "scenario")),
    help="Write the tests: `pytest` files, `csv` tables for monitors, traces for FRET's "
    "simulator, a self-test in `c` or `java`, `mcap` logs for audits, or `scenario` files for the "
    "simulated robot.",
)
@click.option(
    "--language",
    "languages",
    multiple=True,
    type=click.Choice(("python", "c", "js")),
    help="Language of the monitor that the pytest files run. Repeatable.  [default: python]",
)
@path_option(
    "--emit-to", default="build/tests", show_default=True, help="Folder for `--emit`. `-` prints."
)
@click.option(
    "--runs",
    type=click.IntRange(min=1),
    default=40,
    show_default=True,
    help="Maximum number of simulated missions for `--emit scenario`.",
)
@jobs_option
@click.option(
    "--against",
    metavar="CMD",
    help="Test this program. It reads a line of inputs and answers with a line of outputs.",
)
@click.option(
    "--line-time",
    type=click.FloatRange(min=0, min_open=True),
    default=5,
    show_default=True,
    help="Time limit for each answer of the program, in seconds.",
)
@requirements_option
@first_bindings_option
@format_option()
@output_option(
    help="File for the tests, or for the result of --against. `-` prints it.  [default: "
    "build/tests/suite.json, build/tests/conformance.json]"
)
def test(
    files: tuple[str, ...],
    component: str | None,
    requirements: str,
    bindings: str | None,
    against: str | None,
    line_time: float,
    **options: Any,
) -> None:
    """Generate tests from requirements: short traces, each with its expected verdict.

    FILE is a requirement file, or a folder of them; it replaces `--requirements`. Each
    situation of a sentence gets a shortest trace that satisfies the requirement and one that
    violates it. Each mutant of a sentence gets a trace that distinguishes it. All traces
    satisfy the other requirements.

    With `--against`, a program is tested instead: it reads inputs and must answer with outputs
    that satisfy the requirements.

    Exit status: 0 every goal is reached or proved impossible, or the program conforms; 1 the
    program violates a requirement; 2 bad usage or bad input; 3 the search or the test is
    incomplete.

    Example: fretc test requirements/agv --emit pytest
    """
    reads = ("environment", *AUDIT_TABLES)
    checked = requirement_set(files, component, requirements, bindings, reads)
    show, emitted, saved = options["show"], options["emitted"], options["saved"]
    if show is not None:
        _check_shown(show, [requirement.id for requirement in checked.requirements])
    protected = input_files(checked.project, bindings, saved)
    if options["languages"] and emitted != "pytest":
        fail(diagnostic("language_without_pytest"))
    if against is not None:
        if emitted is not None or show is not None:
            fail(diagnostic("against_with_emit"))
        from fretc.commands.test_against import ProgramOptions, test_program

        program = grouped(ProgramOptions, {**options, "command": against, "line_time": line_time})
        raise SystemExit(test_program(checked, program, protected))
    from fretc.commands.test_suite import SuiteOptions, make_tests

    raise SystemExit(make_tests(checked, grouped(SuiteOptions, options), protected))


def _check_shown(id: str, known: list[str]) -> None:
    if id not in known:
        hint = did_you_mean(id, known, f"there are {', '.join(known)}")
        fail(diagnostic("unknown_requirement", id=id, help=hint))
