"""`fretc audit`: check recorded runs against the requirements."""

from __future__ import annotations

import os
import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.audit_logs import selected, time_limits
from fretc.commands.audit_progress import audit_in_memory, audit_into
from fretc.commands.notify import notify, words
from fretc.commands.opening import AUDIT_TABLES
from fretc.commands.summary import summarize
from fretc.terminal.group import CommandWithHeadings
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    bindings_option,
    extras,
    format_option,
    jobs_option,
    label_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    fail,
    not_written,
    painted,
    print_diagnostics,
    print_diagnostics_below,
    print_project_diagnostics,
    print_status,
    protect,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fretc.audit.into_store import ReusableResults, StoreWriter
    from fretc.audit.many_logs import Engine
    from fretc.audit.outputs.totals import VerdictWords
    from fretc.audit.plan import Plan
    from fretc.audit.pool import Limits
    from fretc.audit.store.recordings import SampleCache
    from fretc.commands.audit_outputs import Outcome, Target


_AUDIT = {
    "Input": ("requirements", "bindings", "integrity", "evaluation", "confidence"),
    "Output": ("output_format", "verbose", "output", "parquet", "annotate", "annotations"),
    "Selection": ("since", "sample", "seed"),
    "Many logs, performance": (
        "labels",
        "jobs",
        "log_time",
        "whole_time",
        "engine",
        "rehash",
        "keep_columns",
        "command",
    ),
    "Queries on existing evidence": (
        "summary",
        "query",
    ),
}


@click.command(
    cls=CommandWithHeadings,
    headings=_AUDIT,
    epilog=extras({**LOG_EXTRAS, "fleet": "--engine dask", "parquet": "--parquet"}),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="LOG...")
@requirements_option
@bindings_option
@output_option(
    help="Evidence file (NAME.json), or folder of an evidence store (any other name). `-` "
    "prints the evidence.  [default: build/evidence.json for one log, build/evidence for "
    "several]",
)
@click.option(
    "--annotate",
    is_flag=True,
    help="Also write the verdicts as annotation logs, which Foxglove shows beside each run.",
)
@path_option(
    "--annotations",
    metavar="FOLDER",
    help="Folder for the annotation logs. Implies --annotate.  [default: build/annotations]",
)
@format_option(
    "junit",
    "github",
    "sarif",
    text="Output format. `github`: annotations for GitHub Actions.",
)
@click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="List every result. Without it, many runs are shown as a table of symbols.",
)
@click.option(
    "--evaluation",
    type=click.Choice(("columns", "online")),
    default="columns",
    show_default=True,
    help="How monitors are run: over whole columns at once, or step by step. The results are "
    "the same.",
)
@click.option(
    "--integrity",
    type=click.Choice(("index", "hash", "full")),
    default="hash",
    show_default=True,
    help="How thoroughly a log is checked. `index`: only topics in the bindings are read. "
    "`hash`: also computes the SHA-256 of the file. `full`: also checks every record, CRC "
    "and count.",
)
@click.option(
    "--confidence",
    type=click.FloatRange(min=0.5, max=0.999, min_open=True),
    default=0.95,
    show_default=True,
    help="Confidence level for requirements with a probability.",
)
@label_option
@jobs_option
@click.option(
    "--engine",
    default="local",
    show_default=True,
    help="Where the audit runs: `local`, `dask` (a Dask cluster on this machine) or "
    "dask://HOST:PORT.",
)
@click.option(
    "--since",
    metavar="TIME",
    help="Only logs recorded since this time, for example 2026-11-22, 24h or 7d.",
)
@click.option(
    "--sample",
    type=click.IntRange(min=1),
    metavar="N",
    help="Audit a random sample of at most N logs.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Seed of the random sample.",
)
@click.option(
    "--log-time", metavar="TIME", help="Time limit for each log, for example 90s or 5min."
)
@click.option(
    "--time", "whole_time", metavar="TIME", help="Time limit for the whole audit, for example 6h."
)
@click.option(
    "--keep-columns",
    is_flag=True,
    help="Keep the samples of all logs beside the evidence, so that unchanged logs are not read"
    " again.",
)
@click.option(
    "--rehash",
    is_flag=True,
    help="Identify unchanged logs by SHA-256, not by size and time of change.",
)
@click.option(
    "--notify",
    "command",
    metavar="CMD",
    help="Run CMD at the end, with a JSON summary on its standard input.",
)
@path_option(
    "--parquet", help="Also write a Parquet table with one row for each run and requirement."
)
@click.option(
    "--summary",
    is_flag=True,
    help="Summarize existing evidence: verdict counts, worst runs, "
    "slowest responses. LOG is the evidence; nothing is "
    "audited.",
)
@click.option(
    "--query",
    metavar="SQL",
    help="Query existing evidence with DuckDB SQL. LOG is the evidence; the tables are "
    "`results`, `violations` and `runs`.",
)
def audit(
    paths: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    output: str | None,
    annotate: bool,
    annotations: str | None,
    output_format: str,
    verbose: bool,
    evaluation: str,
    integrity: str,
    confidence: float,
    labels: tuple[str, ...],
    jobs: int,
    engine: str,
    since: str | None,
    sample: int | None,
    seed: int,
    log_time: str | None,
    whole_time: str | None,
    rehash: bool,
    keep_columns: bool,
    command: str | None,
    parquet: str | None,
    summary: bool,
    query: str | None,
) -> None:
    """Check recorded runs against the requirements and give each a verdict.

    LOG is an MCAP file, a ROS bag (.bag, .db3), a folder (all logs below it), a quoted pattern
    ('runs/**/*.mcap'), a URL, a folder or pattern in an object store (s3://bucket/runs/), or
    `-` for standard input. A rosbag2 folder with several files is one log.

    The verdict of a requirement in a run is satisfied, violated, inconclusive, vacuous or no
    data. A requirement with a probability gets one verdict over all runs: supported, refuted or
    inconclusive.

    Exit status: 0 all are satisfied, 1 one is violated, 2 bad usage or bad input, 3 none is
    violated but one is inconclusive, vacuous or has no data.

    Example: fretc audit runs/ --requirements requirements/mission -o build/mission.json
    """
    if summary or query is not None:
        summarize(paths, query, output_format)
    began = time.perf_counter()
    from compiler.project.folder import load
    from compiler.project.paths import companions, requirement_files, sibling_path
    from fretc.audit.log_paths import files_of
    from fretc.audit.outputs.totals import VerdictWords
    from fretc.audit.plan import Plan, planned
    from fretc.commands import audit_outputs as outputs
    from fretc.logs.labels import given
    from fretc.logs.signals.integrity import Integrity

    hook = None if command is None else words(command)
    given_labels = given(labels)
    if isinstance(given_labels, Diagnostic):
        fail(given_labels)
    logs, selection = selected(paths, since, sample, seed)
    limits = time_limits(log_time, whole_time, logs, engine)
    target = outputs.target(output, selection.named if selection else len(logs))
    outputs.check(target, parquet)
    files = requirement_files(requirements)
    if isinstance(files, Diagnostic):
        fail(files)
    inputs = (*files_of(logs), *files, *companions(files), *([bindings] if bindings else []))
    protect([target.path, *([Path(parquet)] if parquet else [])], inputs)
    project = load(
        files, bindings or sibling_path(requirements, "bindings.toml"), reads=AUDIT_TABLES
    )
    print_project_diagnostics(project.diagnostics, requirements)
    plan = planned(project, evaluation, Integrity(integrity), confidence)
    if not isinstance(plan, Plan):
        fail(*(reason for reason in plan if reason not in project.diagnostics))
    plan = replace(plan, labels=given_labels, selection=selection)
    refusals = [reason for reason in plan.refusals if reason not in project.diagnostics]
    print_diagnostics_below(refusals, project.diagnostics)
    kept = _samples(target, rehash=rehash) if keep_columns else None
    with ExitStack() as stack:
        if target.is_store:
            session = stack.enter_context(_session(target.path, plan, logs, rehash=rehash))
            result: outputs.Outcome = audit_into(
                session, _engine(engine, jobs, limits, kept, session.earlier)
            )
        else:
            result = audit_in_memory(plan, logs, _engine(engine, jobs, limits, kept))
        diagnostics = project.answered(result.diagnostics)
        print_diagnostics_below(diagnostics, (*project.diagnostics, *refusals))
        if result.read:  # A mistyped log name must not overwrite the evidence of the last audit.
            wanted = annotate or annotations is not None
            made = outputs.annotation_files(result, project, annotations) if wanted else {}
            if parquet is not None:
                made[Path(parquet)] = outputs.table(result)
            _deliver(result, target, made, inputs)
        elif os.path.lexists(target.path):
            print_status(visible(f"no log could be read: `{target.path}` is unchanged"))
        source, not_judged = result.source, {refusal.id for refusal in plan.refused}
        marks = VerdictWords.of((each for _, each in source.briefs()), result.estimates, not_judged)
        is_bad = plan.refused or has_errors((*project.diagnostics, *diagnostics))
        status = EXIT_USAGE if is_bad else _status(marks)
        from fretc.commands.audit_text import Places, Subject, lines
        from fretc.commands.audit_text import summary as summary_of

        subject = Subject(
            source,
            marks,
            result.estimates,
            project,
            not_judged,
            Places(requirements, bindings, str(target.path)),
            time.perf_counter() - began,
        )
        if output_format == "text":
            from fretc.terminal.screen import screen

            click.echo(painted(lines(subject, screen(), every=verbose)), nl=False)
        else:
            click.echo(outputs.text(result, project, refusals, output_format), nl=False)
        notice = summary_of(subject, status) if hook is not None else {}
    if hook is not None:  # The store is closed first, because the command may read it.
        notify(hook, notice)
    raise SystemExit(status)


def _status(marks: VerdictWords) -> int:
    return EXIT_VIOLATION if marks.violated else EXIT_OK if marks.shown else EXIT_INCONCLUSIVE


def _session(folder: Path, plan: Plan, logs: Sequence[str], *, rehash: bool) -> StoreWriter:
    from compiler.files.user_key import user_key
    from fretc.audit.into_store import StoreWriter, busy

    key = user_key()
    if isinstance(key, Diagnostic):
        print_diagnostics([key])
    known = None if isinstance(key, Diagnostic) else key
    try:
        return StoreWriter(folder, plan, logs, known, rehash=rehash)
    except BlockingIOError:
        fail(busy(folder))
    except OSError as error:
        fail(not_written(str(folder), error.strerror or str(error)))


def _deliver(
    result: Outcome, target: Target, others: Mapping[Path, bytes], inputs: Sequence[str]
) -> None:
    """Write all outputs except a store, which is already written."""
    from fretc.audit.many_logs import Audit
    from fretc.commands.audit_outputs import remove_other

    own: dict[Path, str | bytes] = {}
    if not target.is_store:
        assert isinstance(result, Audit), "what is no store is in memory"
        own = {target.path: result.evidence}
    if {*map(os.path.realpath, own)} & {*map(os.path.realpath, others)}:
        fail(not_written(str(target.path), "two outputs would go there"))
    write_outputs({**own, **others}, inputs)
    if target.is_store:
        print_status(visible(f"wrote {target.path}"))
    remove_other(target)


def _samples(target: Target, *, rehash: bool) -> SampleCache | None:
    """Cache for samples beside the evidence; None without the user's key."""
    from compiler.files.user_key import user_key
    from fretc.audit.store.recordings import SUFFIX, SampleCache

    if str(target.path) == "-":
        fail(_no_place_for_columns("evidence is printed", "name a file with `-o`"))
    key = user_key()
    if isinstance(key, Diagnostic):
        print_diagnostics([key])
        return None
    return SampleCache(target.path.with_name(f"{target.path.name}{SUFFIX}"), key, rehash)


def _no_place_for_columns(why: str, fix: str) -> Diagnostic:
    message = f"`--keep-columns` stores samples beside the evidence on this machine, but {why}"
    return Diagnostic(Code.BAD_USAGE, message, help=fix)


def _engine(
    name: str,
    jobs: int,
    limits: Limits,
    kept: SampleCache | None,
    earlier: ReusableResults | None = None,
) -> Engine:
    if name == "local":
        from fretc.audit.many_logs import local_executor

        if earlier is None:
            return local_executor(jobs, kept, limits=limits)
        return local_executor(jobs, kept, earlier.results, limits)
    if kept is not None:
        why = f"`--engine {name}` reads the logs elsewhere"
        fail(_no_place_for_columns(why, "remove one of the two options"))
    from fretc.audit import dask_executor

    engine = dask_executor.engine(name, jobs)
    if isinstance(engine, Diagnostic):
        fail(engine)
    return engine
