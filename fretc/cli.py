"""Entry point of the command line: parse, run a command, print, exit.

A command imports its libraries when it runs. Exit status: 0 all satisfied or proved, 1 a violation,
2 bad usage or bad input, 3 no violation but something inconclusive; 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path

import click

from compiler.emit import TARGETS
from compiler.files.build_id import __version__
from compiler.files.processes import isolate_imports
from fretc.commands.completion import answer_query
from fretc.terminal.group import DEFAULT, Commands, Registry
from fretc.terminal.output import (
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    final_status,
    not_written,
    print_accepted_count,
    print_diagnostics,
    print_status,
)
from fretc.terminal.screen import IN_ASCII
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.limits import ExceededError, exceeded

_HELP = f"""From FRETish requirements to runtime monitors, audited logs and a traceability report.

`fretc FILE...` formalizes requirements; with `--emit KIND` it generates files from them. Kinds:
{", ".join(TARGETS)}. See also `fretc FILE --help`.
"""


_GROUPS = {
    "Write requirements": {
        "check": ("check:check", "Report errors and warnings of a project, before any run."),
        "write": ("write:write", "Write FRETish from plain English, and choose by short runs."),
        "explain": ("explain:explain", "Explain a requirement with traces, or a message code."),
        "init": ("init:init", "Create a project: requirement, bindings and hazards."),
        "bind": ("bind:bind", "Draft bindings from a log, or check bindings against logs."),
        "info": ("info:info", "Show the topics, rates and damage of recorded runs."),
        "play": ("play:play", "Make a page on which you edit a trace and see the verdicts."),
        "fmt": ("formalize:fmt", "Rewrite sentences in canonical wording."),
        "import": ("formalize:import_", "Import requirements that FRET has exported."),
        "lsp": ("lsp:lsp", "Serve an editor: diagnostics, fixes, completion, rename."),
    },
    "Audit runs": {
        "audit": ("audit:audit", "Check recorded runs against the requirements."),
        "watch": ("watch:watch", "Check a running robot against the requirements."),
        "coverage": ("coverage:coverage", "Show which situations the runs have exercised."),
        "mutate": ("mutate:mutate", "Show which wrong requirements the runs would not detect."),
        "trends": ("trends:trends", "Compare audits: newly violated, fixed, flaky or worse."),
        "simulate": ("simulate:simulate", "Simulate a robot's mission and record it."),
    },
    "Prove and test": {
        "verify": ("verify:verify", "Prove monitors, interceptors and agents."),
        "analyze": ("analyze:analyze", "Find requirements that conflict or are redundant."),
        "test": ("test:test", "Generate tests from requirements, or test a program."),
    },
    "Report and review": {
        "report": ("report:report", "Trace hazard to verdict in one HTML file."),
        "lock": ("review:lock", "Record your review of requirements."),
        "diff": ("review:diff", "Show what has changed since a review."),
        "sign": ("sign:sign", "Sign evidence, proofs, reviews or a report."),
        "verify-evidence": ("verify_evidence:verify_evidence", "Recompute evidence and compare."),
    },
    "Installation": {
        "completion": ("completion:completion", "Print a completion script for your shell."),
        "sbom": ("sbom:sbom", "List the installed components as CycloneDX."),
    },
}
"""Commands by task, the most used first: module and attribute, and the line in the help."""
_COMMANDS = Registry(
    {
        DEFAULT: "fretc.commands.formalize:compile_",
        **{
            name: f"fretc.commands.{place}"
            for commands in _GROUPS.values()
            for name, (place, _) in commands.items()
        },
    }
)
_SUMMARIES = {
    heading: {name: summary for name, (_, summary) in commands.items()}
    for heading, commands in _GROUPS.items()
}


@click.group(
    cls=Commands,
    commands=_COMMANDS,
    summaries=_SUMMARIES,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    help=_HELP,
)
@click.version_option(__version__, prog_name="fretc", message="%(prog)s %(version)s")
@click.option(
    "--parents",
    "folders",
    multiple=True,
    metavar="FOLDER",
    help="Folder outside the project in which parents of requirements may also be. Repeatable.",
)
def cli(folders: tuple[str, ...]) -> None:
    """The command line; its help is `_HELP`."""
    if folders:
        from compiler.files.settings import OUTSIDE

        before = OUTSIDE.set(folders)
        click.get_current_context().call_on_close(lambda: OUTSIDE.reset(before))


def main() -> None:
    """Run the command line; no exception reaches the user as a traceback."""
    _prepare()
    try:
        _run()
        sys.stdout.flush()
        raise SystemExit(EXIT_OK)
    except click.exceptions.Exit as exit_:
        raise SystemExit(exit_.exit_code) from None
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        raise SystemExit(EXIT_OK) from None
    except click.ClickException as error:
        print_diagnostics([_bad_usage(error)])
        raise SystemExit(EXIT_USAGE) from None
    except (click.Abort, KeyboardInterrupt):
        print_status("stopped")
        raise SystemExit(EXIT_INTERRUPTED) from None
    except ExceededError as error:
        print_diagnostics([exceeded(error)])
        raise SystemExit(EXIT_USAGE) from None
    except RecursionError:
        print_diagnostics([diagnostic("api_expression_too_deep")])
        raise SystemExit(EXIT_USAGE) from None
    except OSError as error:
        _no_output(error)
        raise SystemExit(EXIT_USAGE) from None
    except Exception as error:
        said = getattr(error, "diagnostic", None)  # For example a store with a damaged table.
        if isinstance(said, Diagnostic):
            print_diagnostics([said])
            raise SystemExit(EXIT_USAGE) from None
        if "FRETC_TRACEBACK" in os.environ:
            raise
        print_diagnostics([_internal(error)])
        raise SystemExit(EXIT_USAGE) from None


def _prepare() -> None:
    """Make streams and signals safe: a closed pipe or SIGTERM spoils neither exit status nor files.

    Python imports nothing from the current folder.
    """
    isolate_imports()
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=IN_ASCII)
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)


def _run() -> None:
    """Run the command without click's `main`, which maps a closed pipe to exit status 1."""
    if answer_query(cli):
        return
    with cli.make_context("fretc", sys.argv[1:]) as context:
        try:
            cli.invoke(context)
            status = EXIT_OK
        except SystemExit as exit_:
            status = int(exit_.code or EXIT_OK)
        print_accepted_count(context)
        raise SystemExit(final_status(context, status))


def _no_output(error: OSError) -> None:
    """Report that standard output cannot be written; a closed pipe is not reported."""
    if not isinstance(error, BrokenPipeError):
        print_diagnostics([not_written("standard output", error.strerror or str(error))])
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


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
        f"internal error in fretc: {type(error).__name__}{where}: {error}",
        help="please report it together with the input; FRETC_TRACEBACK=1 shows the traceback",
    )
