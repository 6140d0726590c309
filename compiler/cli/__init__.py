"""The command: read, call, print, exit. Nothing heavy is imported before a command needs it.

Exit status: 0 all shown, 1 a violation, 2 bad use or bad input, 3 nothing violated but something
not shown; 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from compiler import __version__
from compiler.cli.group import DEFAULT, Commands
from compiler.cli.output import BAD, INTERRUPTED, SHOWN, say
from compiler.cli.requirements import compile_, fmt, import_
from compiler.cli.runs import audit, report, simulate
from fretish.diagnostic import Code, Diagnostic


@click.group(cls=Commands, no_args_is_help=True)
@click.version_option(__version__, prog_name="fretc", message="%(prog)s %(version)s")
def cli() -> None:
    """From FRETish requirements to monitors, audited logs and a traceability report.

    `fretc FILE...` parses and formalizes requirements; with `--emit` it makes files of them:
    ltl, monitor, ajpf, json, fret-json. `fretc FILE --help` says more.
    """


for _command in (compile_, fmt, import_, audit, report, simulate):
    cli.add_command(_command)


def main() -> None:
    """What the `fretc` command runs: no traceback ever reaches a user."""
    try:
        status = cli.main(prog_name="fretc", standalone_mode=False)
        sys.stdout.flush()
        raise SystemExit(status if isinstance(status, int) else SHOWN)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        raise SystemExit(SHOWN) from None
    except click.ClickException as error:
        say([_bad_usage(error)])
        raise SystemExit(BAD) from None
    except (click.Abort, KeyboardInterrupt):
        click.echo("stopped", err=True)
        raise SystemExit(INTERRUPTED) from None
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(BAD) from None
    except RecursionError:
        say([_too_deep()])
        raise SystemExit(BAD) from None
    except Exception as error:
        if "FRETC_TRACEBACK" in os.environ:
            raise
        say([_internal(error)])
        raise SystemExit(BAD) from None


def _too_deep() -> Diagnostic:
    return Diagnostic(
        Code.TOO_DEEP,
        "an expression has too many operators within each other",
        help="give parts of it names of their own",
    )


def _bad_usage(error: click.ClickException) -> Diagnostic:
    message = error.format_message()
    command = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else ""
    command = command.removesuffix(f" {DEFAULT}") or "fretc"
    return Diagnostic(
        Code.BAD_USAGE,
        f"{message[:1].lower()}{message[1:].rstrip('.')}",
        help=f"see `{command} --help`",
    )


def _internal(error: Exception) -> Diagnostic:
    where = ""
    if error.__traceback__ is not None:
        last = error.__traceback__
        while last.tb_next is not None:
            last = last.tb_next
        where = f" in {Path(last.tb_frame.f_code.co_filename).name}:{last.tb_lineno}"
    return Diagnostic(
        Code.INTERNAL,
        f"fretc itself is at fault: {type(error).__name__}{where}: {error}",
        help="please report it with the input; FRETC_TRACEBACK=1 shows where it comes from",
    )
