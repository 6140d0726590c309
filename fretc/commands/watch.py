"""`fretc watch`: check a running robot against the requirements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import input_files, planned_project
from fretc.terminal.group import CommandWithHeadings
from fretc.terminal.options import PATH, bindings_option, extras, path_option, requirements_option
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    fail,
    not_written,
    or_fail,
    print_diagnostics_below,
    print_status,
    protect,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.project.project import Project
    from fretc.audit.plan import Plan
    from fretc.watch.events import RunEnded
    from fretc.watch.publishing.publishing import Publisher
    from fretc.watch.sources.source import Source

_WATCH = {
    "Input": ("requirements", "bindings", "follow"),
    "Output": ("output_format", "record", "evidence"),
    "Actions": ("publish", "command"),
}


@click.command(
    cls=CommandWithHeadings,
    headings=_WATCH,
    epilog=extras({"live": "dds, foxglove and --publish", "zenoh": "zenoh"}),
)
@click.argument("words", nargs=-1, required=True, type=PATH, metavar="SOURCE...")
@requirements_option
@bindings_option
@click.option("--follow", is_flag=True, help="Wait for more data at the end of the MCAP file.")
@click.option(
    "--format",
    "output_format",
    type=click.Choice(("text", "jsonl")),
    default="text",
    show_default=True,
    help="Output format. `text`: a screen, or lines where there is no terminal. `jsonl`: one JSON "
    "object a line.",
)
@path_option("--record", metavar="FILE", help="Record all messages to this MCAP file.")
@path_option(
    "--evidence",
    metavar="FILE",
    help="At the end, write the evidence of the recording to this file. Needs --record.",
)
@click.option(
    "--publish",
    multiple=True,
    metavar="WHERE",
    help="`diagnostics`: publish the state of each requirement on /diagnostics. "
    "`foxglove[:PORT]`: serve the robot's topics and these states to Foxglove. Repeatable.",
)
@click.option(
    "--on-violation",
    "command",
    metavar="CMD",
    help="Run CMD at each violation, with the facts as JSON on its standard input.",
)
def watch(
    words: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    follow: bool,
    output_format: str,
    record: str | None,
    evidence: str | None,
    publish: tuple[str, ...],
    command: str | None,
) -> None:
    """Check a running robot against all requirements, until Ctrl-C.

    SOURCE is `dds` (ROS 2, domain ROS_DOMAIN_ID), `ros1` (ROS 1, master ROS_MASTER_URI),
    `foxglove ws://HOST:PORT` (a Foxglove server such as foxglove_bridge), `zenoh [LOCATOR]` (ROS 2
    with rmw_zenoh; default tcp/localhost:7447), or an MCAP file; with --follow, a file that is
    still being recorded.

    The verdicts are those that `fretc audit` gives to the recording.

    Exit status: 0 all are satisfied, 1 one is violated, 2 bad usage or bad input, 3 none is
    violated but one is inconclusive, vacuous or has no data.

    Example: fretc watch dds --record run.mcap --evidence build/evidence.json
    """
    from fretc.commands import notify
    from fretc.commands.watch_output import outputs_of, until_stopped, watched
    from fretc.watch.publishing.publishing import Publishing
    from fretc.watch.reaction import Reaction
    from fretc.watch.source_choice import chosen
    from fretc.watch.sources.log import Log
    from fretc.watch.watch import Watch

    if evidence is not None and record is None:
        fail(diagnostic("evidence_needs_recording"))
    reaction = None if command is None else Reaction(notify.words(command, "--on-violation"))
    source = or_fail(chosen(words, follow=follow))
    project, plan, inputs = _planned(requirements, bindings)
    outputs = [Path(name) for name in (record, evidence) if name is not None and name != "-"]
    protect(outputs, [*inputs, *words])
    if record == evidence and record is not None:
        fail(not_written(record, "two outputs would go there"))
    if record == "-":
        fail(not_written(record, "a recording cannot be printed"))
    for path in outputs:
        if path.is_dir():  # Checked before the watch, which may take all night.
            fail(not_written(str(path), "it is a folder"))
    publishers = _opened(publish, source)
    try:
        followed = source.name if isinstance(source, Log) else None
        run = Watch(plan, Path(record) if record is not None else None, followed)
    except OSError as error:
        fail(not_written(str(record), error.strerror or str(error)))
    titles = {requirement.id: requirement.entry.title for requirement in project.formalized}
    shown = outputs_of(output_format, titles)
    with until_stopped() as stopped:
        watched(run, source, shown, reaction, Publishing(publishers), stopped)
    status = EXIT_USAGE if run.failed else _status(run.runs)
    if evidence is not None:
        status = max(status, _audited(plan, run.recordings, evidence, inputs, project))
    raise SystemExit(status)


def _opened(words: Sequence[str], source: Source) -> Sequence[Publisher]:
    """The publishers of verdicts; prints the address of a server."""
    if not words:
        return ()
    from fretc.watch.publishing.choice import addresses, chosen

    publishers = or_fail(chosen(words, source))
    for address in addresses(publishers):
        print_status(f"publishes at {address}: open it in Foxglove")
    return publishers


def _planned(requirements: str, bindings: str | None) -> tuple[Project, Plan, Sequence[str]]:
    """The audit plan, and its input files."""
    project, plan = planned_project(requirements, bindings)
    if plan.declarations.clock.effective_lateness is None:
        fail(_needs_lateness(plan))
    return project, plan, input_files(project, bindings)


def _status(runs: Sequence[RunEnded]) -> int:
    verdicts = {verdict for run in runs for verdict in run.verdicts.values()}
    if "violated" in verdicts:
        return EXIT_VIOLATION
    return EXIT_OK if verdicts == {"satisfied"} else EXIT_INCONCLUSIVE


def _audited(
    plan: Plan, logs: Sequence[str], evidence: str, inputs: Sequence[str], project: Project
) -> int:
    """Audit the recordings and write the evidence."""
    from fretc.audit.many_logs import local_executor
    from fretc.commands.audit_logs import audit_in_memory

    if not logs:
        fail(diagnostic("nothing_recorded"))
    result = audit_in_memory(plan, logs, local_executor(1))
    print_diagnostics_below(project.answered(result.diagnostics), ())
    write_outputs({Path(evidence): result.evidence}, [*inputs, *logs])
    return EXIT_OK if result.read == len(logs) else EXIT_USAGE


def _needs_lateness(plan: Plan) -> Diagnostic:
    source = plan.declarations.source
    start = source.text.find("[clock]")
    return diagnostic(
        "lateness_missing",
        source.span(start, start + len("[clock]")) if start >= 0 else None,
        time=plan.declarations.clock.time,
    )
