"""`fretc test --against`: test whether a program satisfies requirements.

`fretc.testing.conformance` runs the program; this module reads the command, prints and writes.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import Path

import click

from compiler.files.records import plain
from compiler.files.templating import to_json
from fretc.analysis.arena.budget import OutOfTimeError
from fretc.analysis.arena.roles import roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.commands.opening import RequirementSet
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    coloured,
    fail,
    print_diagnostics,
    write_outputs,
)
from fretc.terminal.progress import print_activity
from fretc.testing.conformance.conformance_run import ConformanceRun
from fretc.testing.conformance.findings import Conformance
from fretc.testing.conformance.program import ProgramError, ProgramRun
from fretc.testing.conformance.text_output import lines
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic


@dataclass(frozen=True, slots=True)
class ProgramOptions:
    """The options of `fretc test` about a program."""

    command: str
    """The program and its arguments, in shell syntax."""
    seconds: float
    """CPU seconds for the strategy towards each situation."""
    line_time: float
    """Time limit for each line of the program, in seconds."""
    output_format: str
    output: str | None


def test_program(checked: RequirementSet, options: ProgramOptions, protected: Iterable[str]) -> int:
    """Test a program and print the result; returns the exit status.

    Args:
        checked: the requirements, and the assumptions about the environment.
        options: the program, and how it is tested.
        protected: input files, which no output may replace.
    """
    words = _words(options.command)
    output = options.output or "build/tests/conformance.json"
    chosen, mistakes = roles([*checked.requirements, *checked.assumed])
    if mistakes:
        fail(*mistakes)
    wrong: Diagnostic | None = None
    stopped = False
    try:
        campaign = ConformanceRun(checked.requirements, checked.assumed, chosen, options.seconds)
        oracle = campaign.oracle
        try:
            campaign.run(
                lambda: ProgramRun(words, oracle.inputs, oracle.outputs, options.line_time),
                print_activity,
            )
        except ProgramError as error:
            wrong = error.diagnostic
        except KeyboardInterrupt:
            stopped = True
    except (UnsupportedError, OutOfTimeError) as error:
        fail(diagnostic("no_conformance_test", error=error))
    findings = campaign.findings(words)
    evidence = f"{to_json(plain(findings))}\n"
    if output == "-" or options.output_format == "json":
        click.echo(evidence, nl=False)
    else:
        click.echo(coloured([*lines(findings, chosen)]), nl=False)
    if output != "-":
        write_outputs({Path(output): evidence}, protected)
    if wrong is not None:
        print_diagnostics([wrong])
    return EXIT_INTERRUPTED if stopped else _status(findings, wrong)


def _words(command: str) -> list[str]:
    """The program and its arguments."""
    try:
        words = shlex.split(command)
    except ValueError as error:
        fail(_no_command(command, str(error).lower()))
    if not words:
        fail(_no_command(command, "it is empty"))
    return words


def _no_command(command: str, why: str) -> Diagnostic:
    """F907."""
    return diagnostic("no_program_named", command=shlex.quote(command), why=why)


def _status(found: Conformance, wrong: Diagnostic | None) -> int:
    if found.failures:
        return EXIT_VIOLATION
    if wrong is not None:
        return EXIT_USAGE
    return EXIT_OK if found.is_complete else EXIT_INCONCLUSIVE
