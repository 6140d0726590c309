"""`fretc info`: show the topics, rates and damage of logs."""

from __future__ import annotations

import click

from fretc.terminal.options import LOG_EXTRAS, PATH, extras, format_option
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    or_fail,
    print_diagnostics,
)
from fretish.diagnostics.diagnostic import Diagnostic


@click.command(
    epilog=extras(LOG_EXTRAS),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="LOG...")
@click.option("--all", "whole", is_flag=True, help="List every field that a signal can read.")
@format_option()
def info(paths: tuple[str, ...], whole: bool, output_format: str) -> None:
    """Show the topics, rates and damage of recorded runs.

    LOG is an MCAP file, a ROS bag, a ULog, a DataFlash log, a table (.csv, .jsonl), a folder, a
    quoted pattern ('runs/**/*.mcap'), a URL, or `-` for standard input. For each topic the
    command prints type, count, rate, longest gap, and the fields that a signal in bindings.toml
    can read.

    Exit status: 0 no damage, 3 a log is damaged, 2 a log cannot be read.

    Example: fretc info traces/
    """
    from compiler.files.templating import to_json
    from fretc.audit.log_paths import logs as logs_of
    from fretc.audit.outputs.overview import as_record, text
    from fretc.logs.reader import look

    logs = or_fail(logs_of(paths))
    answers = [look(log) for log in logs]
    wrong = [one for one in answers if isinstance(one, Diagnostic)]
    contents = [one for one in answers if not isinstance(one, Diagnostic)]
    print_diagnostics(
        [*wrong, *(finding for one in contents for finding in one.recording.findings)]
    )
    if output_format == "json":
        click.echo(to_json([as_record(one) for one in contents]))
    else:
        click.echo("\n".join(text(one, whole=whole) for one in contents), nl=False)
    intact = all(one.recording.intact for one in contents)
    raise SystemExit(EXIT_USAGE if wrong else EXIT_OK if intact else EXIT_INCONCLUSIVE)
