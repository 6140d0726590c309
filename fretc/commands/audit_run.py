"""What `fretc audit` does with its options: select, judge, write, print and notify."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compiler.files.user_key import user_key
from compiler.project.folder import load
from compiler.project.paths import companions, requirement_files
from compiler.project.project import Project
from fretc.audit.log_paths import files_of
from fretc.audit.many_logs import AuditOutcome, Engine, local_executor
from fretc.audit.outputs.totals import VerdictWords
from fretc.audit.plan import Plan, planned
from fretc.audit.pool import ENDLESS, Limits
from fretc.commands import audit_outputs as outputs
from fretc.commands.audit_logs import audit_in_memory, selected, shown
from fretc.commands.audit_text import AuditPaths, AuditText, lines
from fretc.commands.audit_text import summary as summary_of
from fretc.commands.notify import notify, words
from fretc.commands.opening import AUDIT_TABLES
from fretc.logs.labels import given
from fretc.logs.signals.integrity import Integrity
from fretc.logs.storage.log_names import STDIN
from fretc.terminal.options import grouped
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    fail,
    not_written,
    or_fail,
    painted,
    print_diagnostics,
    print_diagnostics_below,
    print_project_diagnostics,
    print_status,
    protect,
    write_outputs,
)
from fretc.terminal.screen import screen
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible
from fretish.reading.natural_order import by_place
from fretish.system.processes import FORKS
from fretish.units import nanoseconds

if TYPE_CHECKING:  # pyarrow, which only an audit into a store needs
    from fretc.audit.into_store import ReusableResults, StoredAudit, StoreWriter
    from fretc.audit.store.recordings import SampleCache


@dataclass(frozen=True, slots=True)
class LogOptions:
    """The logs, and which of them are audited."""

    paths: tuple[str, ...]
    since: str | None
    sample: int | None
    seed: int
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """What is checked, and how."""

    requirements: str
    bindings: str | None
    integrity: str
    confidence: float


@dataclass(frozen=True, slots=True)
class EngineOptions:
    """Where and for how long the audit runs, and what it keeps."""

    engine: str
    jobs: int
    log_time: str | None
    whole_time: str | None
    rehash: bool
    keep_columns: bool


@dataclass(frozen=True, slots=True)
class OutputOptions:
    """What is written and printed, and who is notified."""

    output: str | None
    parquet: str | None
    annotate: bool
    annotations: str | None
    output_format: str
    verbose: bool
    command: str | None


@dataclass(frozen=True, slots=True)
class AuditOptions:
    """The options of `fretc audit`."""

    logs: LogOptions
    plan: PlanOptions
    engine: EngineOptions
    outputs: OutputOptions

    @staticmethod
    def of(options: Mapping[str, Any]) -> AuditOptions:
        """The options of the command line."""
        return AuditOptions(
            grouped(LogOptions, options),
            grouped(PlanOptions, options),
            grouped(EngineOptions, options),
            grouped(OutputOptions, options),
        )


@dataclass(frozen=True, slots=True)
class _Job:
    """An audit that can begin."""

    project: Project
    plan: Plan
    logs: Sequence[str]
    target: outputs.EvidencePath
    limits: Limits
    inputs: Sequence[str]
    """Files that no output may replace."""
    refusals: Sequence[Diagnostic]
    """Why some requirements cannot be judged, as far as the project does not say it."""


def run(options: AuditOptions) -> int:
    """Audit the logs, write and print the results, and notify; returns the exit status."""
    began = time.perf_counter()
    command = options.outputs.command
    hook = None if command is None else words(command)
    job = _prepared(options)
    kept = (
        _samples(job.target, rehash=options.engine.rehash) if options.engine.keep_columns else None
    )
    with ExitStack() as stack:
        result = _audited(job, options.engine, kept, stack)
        diagnostics = job.project.answered(result.diagnostics)
        above = (*job.project.diagnostics, *job.refusals)
        _print_findings(diagnostics, above, verbose=options.outputs.verbose)
        _write(job, result, options.outputs)
        subject = _subject(job, result, options.plan, began)
        is_bad = job.plan.refused or has_errors((*job.project.diagnostics, *diagnostics))
        status = EXIT_USAGE if is_bad else _status(subject.marks)
        _print(job, result, subject, options.outputs)
        notice = summary_of(subject, status) if hook is not None else {}
    if hook is not None:  # The store is closed first, because the command may read it.
        notify(hook, notice)
    return status


def _print_findings(
    diagnostics: Sequence[Diagnostic], above: Sequence[Diagnostic], *, verbose: bool
) -> None:
    """Print diagnostics; of the notes that a proposition never changed, a few, unless `verbose`."""
    unchanged = by_place([each for each in diagnostics if each.code is Code.NEVER_CHANGED])
    hidden = [] if verbose or len(unchanged) <= _FEW else unchanged[_FEW:]
    print_diagnostics_below([each for each in diagnostics if each not in hidden], above)
    if hidden:
        print_status(f"\n{len(hidden)} more propositions never changed (F314): `-v` lists them")


_FEW = 3
"""Propositions that never changed, of which each is printed in full."""


# Before the audit -------------------------------------------------------------------------------


def _prepared(options: AuditOptions) -> _Job:
    """Check all options, and print the mistakes of the project."""
    chosen, wanted, written = options.logs, options.plan, options.outputs
    labels = or_fail(given(chosen.labels))
    logs, selection = selected(chosen.paths, chosen.since, chosen.sample, chosen.seed)
    engine = options.engine
    limits = _limits(engine.log_time, engine.whole_time, logs, engine.engine)
    target = outputs.target(written.output, selection.named if selection else len(logs))
    outputs.check(target, written.parquet)
    files = or_fail(requirement_files(wanted.requirements))
    bindings = [wanted.bindings] if wanted.bindings else []
    inputs = (*files_of(logs), *files, *companions(files), *bindings)
    protect([target.path, *([Path(written.parquet)] if written.parquet else [])], inputs)
    project = load(files, wanted.bindings, reads=AUDIT_TABLES)
    print_project_diagnostics(project.diagnostics, wanted.requirements)
    plan = planned(project, Integrity(wanted.integrity), wanted.confidence)
    if not isinstance(plan, Plan):
        fail(*(reason for reason in plan if reason not in project.diagnostics))
    plan = replace(plan, labels=labels, selection=selection)
    refusals = [reason for reason in plan.refusals if reason not in project.diagnostics]
    print_diagnostics_below(refusals, project.diagnostics)
    return _Job(project, plan, logs, target, limits, inputs, refusals)


def _limits(log: str | None, whole: str | None, logs: Sequence[str], engine: str) -> Limits:
    """Time limits for each log and for all logs.

    Args:
        log: `--log-time`; None: no limit.
        whole: `--time`; None: no limit.
        logs: the logs to audit.
        engine: name of the engine.
    """
    limits = Limits(_seconds("--log-time", log), _seconds("--time", whole))
    if limits != ENDLESS and (STDIN in logs or engine != "local"):
        what = "standard input" if STDIN in logs else f"`--engine {engine}`"
        fail(diagnostic("no_time_limits", what=what))
    if limits != ENDLESS and not FORKS:
        fail(diagnostic("no_time_limits_here"))
    return limits


def _seconds(option: str, text: str | None) -> float | None:
    length = None if text is None else nanoseconds(text)
    if text is not None and length is None:
        fail(diagnostic("bad_duration_option", option=option, text=text))
    return None if length is None else length / 1e9


def _samples(target: outputs.EvidencePath, *, rehash: bool) -> SampleCache | None:
    """Cache for samples beside the evidence; None without the user's key."""
    from fretc.audit.store.recordings import SUFFIX, SampleCache

    if target.is_printed:
        fail(diagnostic("columns_beside_printed"))
    key = _key()
    if key is None:
        return None
    return SampleCache(target.path.with_name(f"{target.path.name}{SUFFIX}"), key, rehash)


def _key() -> bytes | None:
    """The user's key; None, with a diagnostic, if there is none."""
    key = user_key()
    if isinstance(key, Diagnostic):
        print_diagnostics([key])
        return None
    return key


# The audit --------------------------------------------------------------------------------------


def _audited(
    job: _Job, options: EngineOptions, kept: SampleCache | None, stack: ExitStack
) -> outputs.CommandOutcome:
    """The results, in memory or in a store, which `stack` closes."""
    if not job.target.is_store:
        return audit_in_memory(job.plan, job.logs, _engine(options, job.limits, kept))
    session = stack.enter_context(_session(job, rehash=options.rehash))
    return _audit_into(session, _engine(options, job.limits, kept, session.earlier))


def _session(job: _Job, *, rehash: bool) -> StoreWriter:
    from fretc.audit.into_store import StoreWriter, busy

    folder = job.target.path
    try:
        return StoreWriter(folder, job.plan, job.logs, _key(), rehash=rehash)
    except BlockingIOError:
        fail(busy(folder))
    except OSError as error:
        fail(not_written(str(folder), error.strerror or str(error)))


def _engine(
    options: EngineOptions,
    limits: Limits,
    kept: SampleCache | None,
    earlier: ReusableResults | None = None,
) -> Engine:
    name, jobs = options.engine, options.jobs
    if name == "local":
        if earlier is None:
            return local_executor(jobs, kept, limits=limits)
        return local_executor(jobs, kept, earlier.results, limits)
    if kept is not None:
        fail(diagnostic("columns_elsewhere", engine=name))
    from fretc.audit import dask_executor

    return or_fail(dask_executor.engine(name, jobs))


def _audit_into(session: StoreWriter, engine: Engine) -> StoredAudit:
    """Audit the logs of a session; an interrupted audit leaves finished results in the store."""
    if session.known:
        count = len(session.known) + len(session.new)
        print_status(
            f"{len(session.known)} of {count} logs are unchanged: their earlier results are reused"
        )
    elif session.earlier.claims:
        print_status(
            "requirements or bindings have changed: the results of "
            f"{len(session.earlier.claims)} unchanged requirements on unchanged logs are reused"
        )
    elif session.earlier.stale:
        print_status("requirements, bindings or fretc have changed: all logs are audited again")
    if session.missing:
        what = "log of the store is" if session.missing == 1 else "logs of the store are"
        whose = "its" if session.missing == 1 else "their"
        print_status(f"{session.missing} {what} not among the inputs: {whose} results are removed")
    if session.earlier.foreign:
        print_status(
            f"`{session.folder}` was written by another user or in another folder: its results "
            "are not reused"
        )
    try:
        with shown(session.new) as show:
            result = session.run(engine, show)
    except KeyboardInterrupt:
        print_status(f"stopped{_kept(session)}")
        raise SystemExit(EXIT_INTERRUPTED) from None
    if isinstance(result, Diagnostic):
        print_diagnostics([result])
        if session.kept:
            print_status(f"not finished{_kept(session)}")
        raise SystemExit(EXIT_USAGE)
    return result


def _kept(session: StoreWriter) -> str:
    """Message about the saved results and how to continue; empty if nothing is saved."""
    if not session.kept:
        return ""
    kept, count = session.kept + len(session.known), len(session.known) + len(session.new)
    return f": {kept} of {count} logs are saved; run the same command again to continue"


# After the audit --------------------------------------------------------------------------------


def _write(job: _Job, result: outputs.CommandOutcome, options: OutputOptions) -> None:
    """Write all outputs; a store is already written."""
    target = job.target
    if not result.read:  # A mistyped log name must not overwrite the evidence of the last audit.
        if os.path.lexists(target.path):
            print_status(visible(f"no log could be read: `{target.path}` is unchanged"))
        return
    others: dict[Path, bytes] = {}
    if options.annotate or options.annotations is not None:
        others = outputs.annotation_files(result, job.project, options.annotations)
    if options.parquet is not None:
        others[Path(options.parquet)] = outputs.table(result)
    own: dict[Path, str | bytes] = {}
    if not target.is_store:
        assert isinstance(result, AuditOutcome), "what is no store is in memory"
        own = {target.path: result.evidence}
    if {*map(os.path.realpath, own)} & {*map(os.path.realpath, others)}:
        fail(not_written(str(target.path), "two outputs would go there"))
    write_outputs({**own, **others}, job.inputs)
    if target.is_store:
        print_status(visible(f"wrote {target.path}"))
    outputs.remove_other(target)


def _subject(
    job: _Job, result: outputs.CommandOutcome, options: PlanOptions, began: float
) -> AuditText:
    """The audit as its text shows it."""
    not_judged = {refusal.id for refusal in job.plan.refused}
    summaries = (each for _, each in result.source.summaries())
    return AuditText(
        result.source,
        VerdictWords.of(summaries, result.estimates, not_judged),
        result.estimates,
        job.project,
        not_judged,
        AuditPaths(options.requirements, options.bindings, str(job.target.path)),
        time.perf_counter() - began,
    )


def _print(
    job: _Job, result: outputs.CommandOutcome, subject: AuditText, options: OutputOptions
) -> None:
    if options.output_format == "text":
        text = painted(lines(subject, screen(), every=options.verbose))
    else:
        text = outputs.text(result, job.project, job.refusals, options.output_format)
    click.echo(text, nl=False)


def _status(marks: VerdictWords) -> int:
    return EXIT_VIOLATION if marks.violated else EXIT_OK if marks.shown else EXIT_INCONCLUSIVE
