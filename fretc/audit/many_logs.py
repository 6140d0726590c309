"""The audit of many logs: read each log, run the monitors, collect the evidence."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import field, replace
from functools import partial
from types import MappingProxyType

from compiler.files.build_id import __version__
from compiler.files.records import UNSET
from compiler.files.records import replace as record_with
from compiler.files.text_files import Stamp, file_sha256, stamp
from fretc.audit.constancy import never_changed, tallies_of, totals
from fretc.audit.evidence.claim import AuditedRequirement
from fretc.audit.evidence.estimates import estimates, warnings
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummary, summary_of
from fretc.audit.evidence.run_plot_data import map_diagnostics, plot_data
from fretc.audit.evidence.schema import (
    SCHEMA,
    BindingsRecord,
    EvidenceDocument,
    Hashes,
    RequirementRecord,
    Result,
    SituationRecord,
)
from fretc.audit.evidence.verdict_inputs import BINDINGS, SENTENCE, of_all
from fretc.audit.evidence.writer import as_record, health, phases_of, unjudged_result, unread_result
from fretc.audit.evidence.writer import text as written
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.one_log import (
    MonitoredRequirement,
    audit,
    examined,
    hash_of,
    hash_of_messages,
    signals_of,
)
from fretc.audit.phases.advice import findings
from fretc.audit.plan import Plan, monitored_requirements
from fretc.audit.pool import (
    ENDLESS,
    Limits,
    TimedOut,
    WorkerDied,
    killed_diagnostic,
    map_processes,
    time_limit_diagnostic,
)
from fretc.audit.store.recordings import KnownBy, SampleCache
from fretc.logs.labels import NO_METADATA, labels, with_overrides
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.storage.log_names import STDIN, name_of
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.caching import cache_by_identity
from monitors import kernel


@dataclass(frozen=True, slots=True)
class AuditOutcome:
    """The outcome of an audit: a result for each run and requirement, ordered by run."""

    document: EvidenceDocument
    diagnostics: tuple[Diagnostic, ...]
    read: int = 0
    """Number of logs that could be read."""

    @property
    def results(self) -> tuple[Result, ...]:
        """One result for each run and requirement."""
        return self.document.results

    @property
    def estimates(self) -> tuple[Estimated, ...]:
        """The answer of all runs for each requirement with a probability."""
        return self.document.probabilities or ()

    @property
    def evidence(self) -> str:
        """The text of the evidence file."""
        return written(self.document)

    @property
    def source(self) -> EvidenceSource:
        """The results as an `EvidenceSource`."""
        return EvidenceFile("", "", self.document)


@dataclass(frozen=True, slots=True)
class LogResult:
    """The outcome of the audit of one log."""

    results: tuple[Result, ...]
    """The result of each requirement, in order."""
    diagnostics: tuple[Diagnostic, ...]
    read: bool
    """Whether the log could be read."""
    stamp: Stamp | None = None
    """The stamp of the file before its audit; None: it is not a file, or has changed since."""
    known_by: KnownBy = field(default="read", compare=False)
    """Whether the log was read, or how it was identified as unchanged."""


LogAudits = Generator[tuple[str, LogResult] | Diagnostic, None, None]
"""Each log with its result, as soon as it is complete; a diagnostic if the executor gives up."""

Engine = Callable[[Plan, Sequence[str]], LogAudits]
"""The executor of the audits of logs. Closing its iterator ends all work at once."""


def _nothing(_: str) -> Sequence[Result]:
    return ()


def local_executor(
    jobs: int,
    kept: SampleCache | None = None,
    known: Callable[[str], Sequence[Result]] = _nothing,
    limits: Limits = ENDLESS,
) -> Engine:
    """The executor on this machine, with several processes.

    Args:
        jobs: the number of processes.
        kept: the cache of the samples of logs.
        known: the reusable results of a log, by requirement.
        limits: limits of time; a process for standard input has none.
    """

    def judged(plan: Plan, log: str) -> LogResult:
        return audit_log(plan, log, known(log), kept)

    def engine(plan: Plan, logs: Sequence[str]) -> LogAudits:
        monitored_requirements(plan)  # loaded before the fork, so that processes inherit it
        if STDIN in logs:  # only this process can read standard input
            yield STDIN, audit_log(plan, STDIN)
        files = [log for log in logs if log != STDIN]
        with closing(map_processes(partial(judged, plan), files, jobs, limits)) as done:
            for index, result in done:
                log = files[index]
                if isinstance(result, WorkerDied):
                    yield log, results_of_killed_process(plan, log, str(result))
                elif isinstance(result, TimedOut):
                    yield log, _unaudited(plan, log, time_limit_diagnostic(log, result, limits))
                else:
                    yield log, result

    return engine


SEQUENTIAL = local_executor(1)
"""The executor that audits one log after the other."""


def audit_logs(
    plan: Plan,
    logs: Sequence[str],
    engine: Engine = SEQUENTIAL,
    finished: Mapping[str, LogResult] = MappingProxyType({}),
    tell: Callable[[str, LogResult], None] = lambda log, result: None,
) -> AuditOutcome | Diagnostic:
    """Audit every log against every requirement.

    Args:
        plan: the requirements, and how they are judged.
        logs: files, folders of rosbag2, URLs, or `-` for standard input, each once.
        engine: the executor; the results do not depend on it.
        finished: the results of logs that were audited with this plan before.
        tell: is called with each other log when it is done.

    Returns:
        The audit, which depends on neither the engine nor the order in which logs were done; or
        why the engine gave up.
    """
    done = {log: finished[log] for log in logs if log in finished}
    with closing(engine(plan, [log for log in logs if log not in done])) as items:
        for item in items:
            if isinstance(item, Diagnostic):
                return item
            log, one = item
            assert log not in done
            done[log] = one
            tell(log, one)
    return combined_audit(plan, [with_command_labels(plan, done[log]) for log in logs])


def combined_audit(plan: Plan, audits: Sequence[LogResult]) -> AuditOutcome:
    """One audit from the results of single logs, in their order."""
    results = [result for audit in audits for result in audit.results]
    of_all_runs = estimates_of(plan, map(summary_of, results))
    tallies = (tallies_of(audit.results) for audit in audits)
    of_logs = [(audit.results[0].run, audit.diagnostics) for audit in audits]
    return AuditOutcome(
        document(plan, results, of_all_runs),
        diagnostics_of_all(plan, of_logs, tallies, of_all_runs),
        sum(audit.read for audit in audits),
    )


def estimates_of(plan: Plan, results: Iterable[ResultSummary]) -> tuple[Estimated, ...]:
    """The answer of all runs for each requirement with a probability."""
    ids = {claim.id for claim in plan.claims if claim.chance is not None}
    counted = [result for result in results if result.requirement in ids] if ids else []
    return estimates(plan.claims, counted, plan.confidence)


def diagnostics_of_all(
    plan: Plan,
    of_logs: Sequence[tuple[str, Sequence[Diagnostic]]],
    tallies: Iterable[Mapping[str, PropositionTally]],
    of_all_runs: Sequence[Estimated],
) -> tuple[Diagnostic, ...]:
    """The diagnostics of all logs together.

    Args:
        plan: the plan of the audit.
        of_logs: the name of each run, and the diagnostics of its log.
        tallies: the tally of each proposition in each run.
        of_all_runs: the answer of all runs for each requirement with a probability.
    """
    diagnostics = _shared(of_logs)
    constant = never_changed(totals(tallies), plan.declarations, diagnostics)
    return (*diagnostics, *constant, *warnings(of_all_runs))


def _shared(of_logs: Sequence[tuple[str, Sequence[Diagnostic]]]) -> tuple[Diagnostic, ...]:
    """The diagnostics of all logs. A diagnostic that several logs share is given once."""
    runs: dict[Diagnostic, list[str]] = {}
    for run, diagnostics in of_logs:
        for diagnostic in diagnostics:
            runs.setdefault(diagnostic, []).append(run)
    return tuple(_of(diagnostic, of, len(of_logs)) for diagnostic, of in runs.items())


def _of(diagnostic: Diagnostic, runs: Sequence[str], count: int) -> Diagnostic:
    """The diagnostic with the names of its logs, unless its place is in one log."""
    if count == 1 or (diagnostic.span and diagnostic.span.source.name == runs[0]):
        return diagnostic
    which = f"in {len(runs)} of {count} logs, first in `{runs[0]}`"
    return replace(diagnostic, message=f"{diagnostic.message} ({which})")


def audit_log(
    plan: Plan, log: str, known: Sequence[Result] = (), kept: SampleCache | None = None
) -> LogResult:
    """Audit one log; all other inputs are in the plan.

    Args:
        plan: the requirements, and how they are judged.
        log: its path.
        known: results of an earlier audit of the log, by requirements whose `keys` are unchanged.
            They are reused if the log is unchanged; facts about the log itself are computed again.
        kept: the cache of the samples of logs: an unchanged log is not read again.
    """
    declarations, requirements = plan.declarations, monitored_requirements(plan)
    before = stamp(log)
    names = _propositions(requirements)
    recording, by = _read(plan, log, names, kept, before)
    if isinstance(recording, Diagnostic):
        return _unread(plan, log, recording, before)
    recording = examined(recording, declarations, names)
    taken = {each.requirement: each for each in _taken_over(known, recording)}
    new = [
        requirement
        for requirement in requirements
        if requirement.monitor.REQUIREMENTS[0].id not in taken
    ]
    evidence = audit(recording, declarations, new) if new else ()
    of_claim = {e.requirement: as_record(e) for e in evidence} | taken
    first, *others = (of_claim[claim.id] for claim in plan.claims)
    records = (record_with(first, course=plot_data(recording, declarations) or UNSET), *others)
    phased = {record.requirement: phases_of(record.phases) for record in records if record.phases}
    own = LogResult(
        (*records, *_refused_results(plan, first)),
        (
            *recording.findings,
            *findings(phased, declarations),
            *map_diagnostics(recording, declarations),
        ),
        read=True,
        stamp=before if before == stamp(log) else None,
        known_by=by,
    )
    return _with_own_labels(plan, own, recording.described)


@cache_by_identity
def _propositions(requirements: Sequence[MonitoredRequirement]) -> tuple[str, ...]:
    return tuple(
        dict.fromkeys(name for requirement in requirements for name in requirement.propositions)
    )


def _read(
    plan: Plan, log: str, names: Sequence[str], kept: SampleCache | None, before: Stamp | None
) -> tuple[Recording | Diagnostic, KnownBy]:
    """The recording of a log with all signals of the propositions, read or from the cache."""
    declarations, integrity = plan.declarations, plan.integrity
    signals = signals_of(declarations, names)
    cached = kept.recording(log, declarations, signals, integrity) if kept else None
    if cached is not None:
        return cached
    drawn = declarations.map
    beside = (drawn.x, drawn.y) if drawn else ()
    recording = read(log, declarations, signals, integrity, beside)
    if kept is not None and isinstance(recording, Recording) and before == stamp(log):
        kept.keep(log, before, recording, declarations, signals, integrity)
    return recording, "read"


def _taken_over(known: Sequence[Result], recording: Recording) -> Iterator[Result]:
    """The results that an audit of the recording would give again.

    The topic of another requirement may be the reason for missing data: such a result is reused
    only if all diagnostics of the log are equal.
    """
    if not known:
        return
    now, log = health(recording), hash_of(recording)
    messages = hash_of_messages(recording)
    for one in known:
        then, hashes = one.health, {**one.hashes}
        same_log = one.run == recording.name and log.items() <= hashes.items()
        same_time = (one.start_ns, one.end_ns) == (recording.start_ns, recording.end_ns)
        same_loss = (then.intact, then.gaps) == (now.intact, now.gaps)
        same_cause = one.verdict != kernel.NO_DATA or then == now
        if same_log and same_time and same_loss and same_cause:
            if hashes.pop("messages", None) is not None or one.outcomes is not UNSET:
                hashes |= messages
            alike = {"health": now, "labels": UNSET, "course": UNSET}
            yield record_with(one, fingerprints=Hashes(**hashes), **alike)


def _with_own_labels(
    plan: Plan, one: LogResult, described: Mapping[str, tuple[str, ...]] = NO_METADATA
) -> LogResult:
    """The result of a log, with the labels that the bindings ask for."""
    declared = plan.declarations.labels
    if not declared:
        return one
    own_labels, notes = labels(declared, one.results[0].run, described)
    return _with_labels(one, own_labels, notes)


def with_command_labels(plan: Plan, one: LogResult) -> LogResult:
    """The result of a log, with the labels that the command gives all runs."""
    if not plan.labels:
        return one
    first = one.results[0]
    all_labels, notes = with_overrides(first.labels or {}, plan.labels)
    return _with_labels(one, all_labels, notes)


def _with_labels(
    one: LogResult, labels: Mapping[str, str], notes: Sequence[Diagnostic]
) -> LogResult:
    of_run = dict(sorted(labels.items())) or UNSET
    return replace(
        one,
        results=tuple(record_with(result, labels=of_run) for result in one.results),
        diagnostics=(*one.diagnostics, *notes),
    )


def _refused_results(plan: Plan, sibling: Result) -> Iterator[Result]:
    """The result of each requirement that cannot be judged, in a run: no data, with the reason.

    Args:
        plan: the plan with the refused requirements.
        sibling: the result of a judged requirement in the same run.
    """
    log = {name: sha for name, sha in sibling.hashes.items() if name.startswith("log")}
    for refused in plan.refused:
        yield unjudged_result(
            sibling.run,
            refused.id,
            f"not judged: {'; '.join(f'{d.code.number} {d.message}' for d in refused.why)}",
            {**log, **refused.verdict_inputs},
            sibling.health,
        )


def results_of_killed_process(plan: Plan, log: str, how: str) -> LogResult:
    """The results of a log whose audit killed its process twice: no data.

    Args:
        plan: the plan of the audit.
        log: its path.
        how: how the process ended.
    """
    return _unread(plan, log, killed_diagnostic(log, how), None)


def _unread(plan: Plan, log: str, why: Diagnostic, before: Stamp | None) -> LogResult:
    """The results of a log that cannot be read.

    Args:
        plan: the plan of the audit.
        log: its path.
        why: the diagnostic that says why the log cannot be read.
        before: the stamp of the log before the attempt; None: it is unknown.
    """
    hashes = _hash_of(log, before)
    records = [
        unread_result(name_of(log), requirement.id, why, {**hashes, **requirement.verdict_inputs})
        for requirement in plan.named
    ]
    return _with_own_labels(plan, LogResult(tuple(records), (why,), read=False))


def _unaudited(plan: Plan, log: str, why: Diagnostic) -> LogResult:
    """The results of a log that was not audited before the time limit: no data, and no hash."""
    records = [
        unread_result(name_of(log), requirement.id, why, requirement.verdict_inputs)
        for requirement in plan.named
    ]
    return _with_own_labels(plan, LogResult(tuple(records), (why,), read=False))


def _hash_of(log: str, before: Stamp | None) -> dict[str, str]:
    """SHA-256 of a file that could not be read as a log, if it is unchanged since the attempt."""
    digest = file_sha256(log)
    changed = before is not None and stamp(log) != before
    return {} if digest is None or changed else {"log": digest}


def named_situations(claim: AuditedRequirement) -> tuple[SituationRecord, ...]:
    """The situations of a requirement, as evidence lists them."""
    return tuple(SituationRecord(situation.key, situation.words) for situation in claim.situations)


def document(
    plan: Plan, results: Sequence[Result], of_all_runs: Sequence[Estimated]
) -> EvidenceDocument:
    """The evidence document of an audit."""
    return EvidenceDocument(
        schema=SCHEMA,
        fretc=__version__,
        bindings=BindingsRecord(
            plan.declarations.source.name,
            of_all(
                {requirement.id: requirement.verdict_inputs[BINDINGS] for requirement in plan.named}
            ),
        ),
        requirements=tuple(
            RequirementRecord(
                requirement.id,
                requirement.sentence,
                requirement.verdict_inputs[SENTENCE],
                situations=named_situations(requirement)
                if isinstance(requirement, AuditedRequirement)
                else UNSET,
            )
            for requirement in plan.named
        ),
        results=tuple(results),
        probabilities=tuple(of_all_runs) or UNSET,
        selection=plan.selection or UNSET,
    )
