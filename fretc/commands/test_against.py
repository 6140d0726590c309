"""`fretc test --against`: test whether a program satisfies requirements.

`fretc.testing.conformance` runs the program; this module reads the command, prints and writes.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

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
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from fretc.testing.conformance.findings import Conformance


def against(
    command: str,
    requirements: Sequence[FormalizedRequirement],
    assumed: Sequence[FormalizedRequirement],
    seconds: float,
    line_time: float,
    output_format: str,
    output: str,
    protected: Iterable[str],
) -> NoReturn:
    """Test a program, print the result, and exit.

    Args:
        command: the program and its arguments, in shell syntax.
        requirements: the requirements.
        assumed: the assumptions about the environment.
        seconds: CPU seconds for the strategy towards each situation.
        line_time: time limit for each line of the program, in seconds.
        output_format: text or json.
        output: path of the result; `-` prints it.
        protected: input files, which no output may replace.
    """
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from fretc.analysis.arena.budget import OutOfTimeError
    from fretc.analysis.arena.roles import roles
    from fretc.analysis.arena.variables import UnsupportedError
    from fretc.terminal.progress import print_activity
    from fretc.testing.conformance.conformance_run import ConformanceRun
    from fretc.testing.conformance.program import Program, ProgramError
    from fretc.testing.conformance.text_output import lines

    words = _words(command)
    chosen = roles([*requirements, *assumed])
    if isinstance(chosen, tuple):
        fail(*chosen)
    wrong: Diagnostic | None = None
    stopped = False
    try:
        campaign = ConformanceRun(requirements, assumed, chosen, seconds)
        oracle = campaign.oracle
        try:
            campaign.run(
                lambda: Program(words, oracle.inputs, oracle.outputs, line_time), print_activity
            )
        except ProgramError as error:
            wrong = error.diagnostic
        except KeyboardInterrupt:
            stopped = True
    except (UnsupportedError, OutOfTimeError) as error:
        fail(diagnostic("no_conformance_test", error=error))
    found = campaign.findings(words)
    evidence = f"{to_json(plain(found))}\n"
    if output == "-" or output_format == "json":
        click.echo(evidence, nl=False)
    else:
        click.echo(coloured([*lines(found, chosen)]), nl=False)
    if output != "-":
        write_outputs({Path(output): evidence}, protected)
    if wrong is not None:
        print_diagnostics([wrong])
    if stopped:
        raise SystemExit(EXIT_INTERRUPTED)
    raise SystemExit(_status(found, wrong))


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
