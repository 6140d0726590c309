"""Audits of recorded logs: `audit_logs` and its result."""

from __future__ import annotations

import os

from compiler.project.project import Project
from fretc.api.refusal import Refusal, accepted, bounded
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.log_paths import logs as logs_of
from fretc.audit.many_logs import AuditOutcome as Run
from fretc.audit.many_logs import audit_logs as audited
from fretc.audit.many_logs import local_executor
from fretc.audit.outputs.totals import VerdictWords
from fretc.audit.plan import Plan, planned
from fretc.logs.signals.integrity import Integrity
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

Path = str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class Audit:
    """The result of an audit: verdicts on the requirements in the logs."""

    results: tuple[Result, ...]
    """One result for each log and requirement in force, also if nothing could be judged."""
    probabilities: tuple[Estimated, ...]
    """The estimate over all logs for each requirement with a probability."""
    diagnostics: tuple[Diagnostic, ...]
    """Diagnostics about logs, and about requirements that cannot be judged."""
    violated: bool
    """Whether a requirement is violated in a log, or refuted by the estimate over all logs."""
    shown: bool
    """Whether each requirement is satisfied in every log, or supported by the estimate."""
    evidence: str
    """The text of the evidence file, as `fretc audit` writes it."""


@bounded
def audit_logs(
    project: Project,
    *logs: Path,
    integrity: str = "hash",
    confidence: float = 0.95,
    jobs: int = 1,
) -> Audit:
    """Judge logs by every requirement in force.

    A log that cannot be read, and a requirement that cannot be judged, have results with the
    verdict `no data` and a reason.

    Args:
        project: the requirements and their bindings.
        logs: files, folders of them, patterns, or URLs.
        integrity: how thoroughly a log is checked: `index`, `hash` or `full`.
        confidence: of the estimate of a probability over all logs, between 0.5 and 1.
        jobs: number of parallel processes.

    Raises:
        Refusal: no log is given, a file does not exist, or no requirement can be judged.
    """
    error = _bad_choice(integrity, confidence, jobs)
    if error is not None:
        raise Refusal((error,))
    named = accepted(logs_of([os.fspath(log) for log in logs]))
    if not named:
        raise Refusal((diagnostic("no_log_given"),))
    plan = planned(project, integrity=Integrity(integrity), confidence=confidence)
    if not isinstance(plan, Plan):
        raise Refusal(plan)
    return _audit(plan, accepted(audited(plan, named, local_executor(jobs))))


def _audit(plan: Plan, run: Run) -> Audit:
    marks = VerdictWords.of((each for _, each in run.source.summaries()), run.estimates)
    return Audit(
        run.results,
        run.estimates,
        tuple(dict.fromkeys((*plan.refusals, *run.diagnostics))),
        marks.violated,
        marks.shown,
        run.evidence,
    )


def _bad_choice(integrity: str, confidence: float, jobs: int) -> Diagnostic | None:
    if integrity not in list(Integrity):
        levels = ", ".join(Integrity)
        return diagnostic("unknown_integrity_level", integrity=integrity, levels=levels)
    if not 0.5 < confidence < 1:
        return diagnostic("bad_confidence", confidence=confidence)
    if jobs < 1:
        return diagnostic("too_few_processes", jobs=jobs)
    return None
