"""From a plan and logs to verdicts: read each log, run the monitors, gather the evidence."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

from compiler.files.edition import __version__
from compiler.files.records import UNSET, plain
from compiler.files.records import replace as with_fields
from compiler.files.templating import to_json
from compiler.files.text_files import Stamp, file_sha256, stamp
from fretc.audit.constancy import never_changed, tallies_of
from fretc.audit.evidence.basis import BINDINGS, SENTENCE, of_all
from fretc.audit.evidence.courses import course, no_way
from fretc.audit.evidence.estimates import estimates, warnings
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import SCHEMA, Bindings, Document, Requirement, Result
from fretc.audit.evidence.verdicts import VERDICTS
from fretc.audit.evidence.writer import as_record, unjudged, unread
from fretc.audit.evidence.writer import text as written
from fretc.audit.measurements.confidence_intervals import REFUTED, SUPPORTED
from fretc.audit.measurements.judgement import Engine as Evaluation
from fretc.audit.one_log import audit, examined, signals_of
from fretc.audit.phases.advice import findings
from fretc.audit.plan import Plan, monitored_requirements
from fretc.audit.pool import Killed, each, was_killed
from fretc.logs.reader import read
from fretc.logs.storage.inputs import STDIN
from fretc.logs.storage.inputs import shown as called
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import visible
from monitors import kernel


@dataclass(frozen=True, slots=True)
class Audit:
    """The outcome of an audit: one result for each run and requirement, runs in their order."""

    results: tuple[Result, ...]
    evidence: str
    """The text of the evidence file."""
    diagnostics: tuple[Diagnostic, ...]
    read: int = 0
    """How many of the logs could be read."""
    estimates: tuple[Estimated, ...] = ()
    """What all runs say of each requirement with a probability."""

    @property
    def violated(self) -> bool:
        """Whether any requirement is violated in any run, or refuted by all of them."""
        return any(one.answer == REFUTED for one in self.estimates) or any(
            result.verdict == kernel.VIOLATED for result in self.results
        )

    @property
    def shown(self) -> bool:
        """Whether every requirement is satisfied in every run, or supported by all of them."""
        of_all_runs = {one.requirement for one in self.estimates}
        return all(one.answer == SUPPORTED for one in self.estimates) and all(
            result.verdict == kernel.SATISFIED
            for result in self.results
            if result.requirement not in of_all_runs
        )

    @property
    def as_json(self) -> str:
        """One JSON array, an object per run and requirement; with probabilities, both by name."""
        results = plain(self.results)
        if not self.estimates:
            return f"{to_json(results)}\n"
        return f"{to_json({'results': results, 'probabilities': plain(self.estimates)})}\n"

    @property
    def text(self) -> tuple[tuple[str, str | None], ...]:
        """Lines for a person, each with its colour."""
        lines: list[tuple[str, str | None]] = []
        width = max((len(result.requirement) for result in self.results), default=0)
        run = None
        for result in self.results:
            if result.run != run:
                run = result.run
                lines.append((run, None))
            verdict = VERDICTS[result.verdict]
            name = f"{result.requirement:<{width}}"
            line = f"  {verdict.sign.glyph} {name}  {verdict.word:<12}  {result.reason}"
            lines.append((line, verdict.sign.colour))
        lines.extend(estimate_lines(self.estimates))
        return tuple((visible(line), colour) for line, colour in lines)


def estimate_lines(estimates: Sequence[Estimated]) -> tuple[tuple[str, str | None], ...]:
    """What all runs say of each requirement with a probability, each line with its colour."""
    return tuple(line for one in estimates for line in _block(one))


def _block(one: Estimated) -> Iterator[tuple[str, str | None]]:
    """What all runs say of one requirement, the answer in its colour."""
    first, *rest = one.lines
    verdict = VERDICTS[one.answer]
    yield f"{one.requirement} over all runs, {one.text}", None
    yield f"  {verdict.sign.glyph} {first}", verdict.sign.colour
    yield from ((f"    {line}", None) for line in rest)


EVALUATIONS: Mapping[str, Evaluation] = {"columns": kernel.evaluate, "online": kernel.stepped}
"""How monitors are run: whole traces at once, or step by step."""


@dataclass(frozen=True, slots=True)
class LogAudit:
    """The outcome of the audit of one log."""

    results: tuple[Result, ...]
    """The record of each claim, in their order."""
    diagnostics: tuple[Diagnostic, ...]
    read: bool
    """Whether the log could be read."""
    stamp: Stamp | None = None
    """The file's before its audit; None where it is no file, or has changed since."""


LogAudits = Generator[tuple[str, LogAudit] | Diagnostic, None, None]
"""Each log with its audit, as soon as that is complete; a diagnostic where the engine gives up."""

Engine = Callable[[Plan, Sequence[str]], LogAudits]
"""Where logs are audited. Closing what it gives ends all work at once."""


def locally(jobs: int) -> Engine:
    """On this machine, in some processes."""

    def engine(plan: Plan, logs: Sequence[str]) -> LogAudits:
        monitored_requirements(plan)  # before the processes are born: they inherit it
        if STDIN in logs:  # another process does not have it
            yield STDIN, audited(plan, STDIN)
        files = [log for log in logs if log != STDIN]
        with closing(each(partial(audited, plan), files, jobs)) as done:
            for place, result in done:
                log = files[place]
                if isinstance(result, Killed):
                    yield log, given_up(plan, log, str(result))
                else:
                    yield log, result

    return engine


IN_TURN = locally(1)
"""One after the other."""


def audit_logs(
    plan: Plan,
    logs: Sequence[str],
    engine: Engine = IN_TURN,
    finished: Mapping[str, LogAudit] = MappingProxyType({}),
    tell: Callable[[str, LogAudit], None] = lambda log, audited: None,
) -> Audit | Diagnostic:
    """Audit every log against every claim.

    Args:
        plan: what the logs are judged by.
        logs: files, folders of rosbag2, URLs, or `-` for standard input, each once.
        engine: where; the results do not depend on it.
        finished: logs that have been audited by this plan already.
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
    return gathered(plan, [done[log] for log in logs])


def gathered(plan: Plan, audits: Sequence[LogAudit]) -> Audit:
    """One audit of the audits of single logs, in their order."""
    results = [result for one in audits for result in one.results]
    diagnostics = _diagnostics(audits)
    of_all_runs = estimates(plan.claims, results, plan.confidence)
    constant = never_changed(tallies_of(results), plan.declarations, diagnostics)
    return Audit(
        tuple(results),
        written(_evidence(plan, results, of_all_runs)),
        (*diagnostics, *constant, *warnings(of_all_runs)),
        sum(one.read for one in audits),
        of_all_runs,
    )


def _diagnostics(audits: Sequence[LogAudit]) -> tuple[Diagnostic, ...]:
    """The diagnostics of all logs. One that several logs share is given once."""
    runs: dict[Diagnostic, list[str]] = {}
    for one in audits:
        for diagnostic in one.diagnostics:
            runs.setdefault(diagnostic, []).append(one.results[0].run)
    return tuple(_of(diagnostic, of, len(audits)) for diagnostic, of in runs.items())


def _of(diagnostic: Diagnostic, runs: Sequence[str], count: int) -> Diagnostic:
    """The diagnostic. Unless its place is in one log, the message says in which logs it is."""
    if count == 1 or (diagnostic.span and diagnostic.span.source.name == runs[0]):
        return diagnostic
    which = f"in {len(runs)} of {count} logs, first in `{runs[0]}`"
    return replace(diagnostic, message=f"{diagnostic.message} ({which})")


def audited(plan: Plan, log: str) -> LogAudit:
    """Audit one log; all that is needed for it is in the plan."""
    declarations, requirements = plan.declarations, monitored_requirements(plan)
    before = stamp(log)
    names = tuple(dict.fromkeys(name for each in requirements for name in each.propositions))
    drawn = declarations.map
    beside = (drawn.x, drawn.y) if drawn else ()
    wanted = signals_of(declarations, names)
    recording = read(log, declarations, wanted, plan.integrity, beside)
    if isinstance(recording, Diagnostic):
        return _unread(plan, log, recording, before)
    recording = examined(recording, declarations, names)
    evidence = audit(recording, declarations, requirements, EVALUATIONS[plan.evaluation])
    phased = {e.requirement: e.phases for e in evidence if e.phases is not None}
    records = [as_record(e) for e in evidence]
    results = (*records, *_refused_results(plan, records[0]))
    seen = course(recording, declarations)
    return LogAudit(
        (with_fields(results[0], course=seen), *results[1:]) if seen else results,
        (*recording.findings, *findings(phased, declarations), *no_way(recording, declarations)),
        read=True,
        stamp=before if before == stamp(log) else None,
    )


def _refused_results(plan: Plan, sibling: Result) -> Iterator[Result]:
    """The result of each refused requirement in a run: no data, and the reason.

    Args:
        plan: which requirements it refuses.
        sibling: the result of a judged requirement in the same run.
    """
    log = {name: sha for name, sha in sibling.hashes.items() if name.startswith("log")}
    for refused in plan.refused:
        yield unjudged(
            sibling.run,
            refused.id,
            f"not judged: {'; '.join(f'{d.code.number} {d.message}' for d in refused.why)}",
            {**log, **refused.basis},
            sibling.health,
        )


def given_up(plan: Plan, log: str, how: str) -> LogAudit:
    """The results of a log whose audit killed its process twice: no data.

    Args:
        plan: what it was to be judged by.
        log: its path.
        how: the process ended.
    """
    return _unread(plan, log, was_killed(log, how), None)


def _unread(plan: Plan, log: str, why: Diagnostic, before: Stamp | None) -> LogAudit:
    """The results of a log that cannot be read.

    Args:
        plan: what it was to be judged by.
        log: its path.
        why: what keeps it from being read.
        before: its stamp before that was tried; None: it is not known.
    """
    hashes = _hash_of(log, before)
    records = [unread(called(log), each.id, why, {**hashes, **each.basis}) for each in plan.named]
    return LogAudit(tuple(records), (why,), read=False)


def _hash_of(log: str, before: Stamp | None) -> dict[str, str]:
    """SHA-256 of a log that could not be read as one, where it is still what was tried."""
    digest = file_sha256(log)
    changed = before is not None and stamp(log) != before
    return {} if digest is None or changed else {"log": digest}


def _evidence(plan: Plan, results: Sequence[Result], of_all_runs: Sequence[Estimated]) -> Document:
    return Document(
        schema=SCHEMA,
        fretc=__version__,
        bindings=Bindings(
            plan.declarations.source.name,
            of_all({each.id: each.basis[BINDINGS] for each in plan.named}),
        ),
        requirements=tuple(
            Requirement(each.id, each.sentence, each.basis[SENTENCE]) for each in plan.named
        ),
        results=tuple(results),
        probabilities=tuple(of_all_runs) or UNSET,
    )
