"""Mutants of requirements that recorded runs notice.

A run notices a mutant if the known verdicts of requirement and mutant differ, or if at a tick
exactly one of them is certainly violated. Unknown values notice nothing. One monitor judges all
mutants of a requirement, over the columns of its audit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial

from compiler.formalization.formalized import FormalizedRequirement, without_probability
from compiler.formalization.resolution import with_propositions
from compiler.project.project import Project
from compiler.situations.mutants import Mutant, mutants
from compiler.targets.python import monitor as monitors
from fretc.audit.measurements.judgement import Judgement, judge
from fretc.audit.plan import Plan
from fretc.audit.pool import WorkerDied, killed_diagnostic, map_processes
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.traces import Trace, trace
from fretc.logs.storage.log_names import STDIN, name_of
from fretc.testing.suite import MutantStatus, Suite
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from monitors import kernel
from monitors.kernel import Column, Monitor, Outcome
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


@dataclass(frozen=True)
class MutantBatch:
    """A requirement and its mutants in one monitor, in which the requirement comes first."""

    id: str
    fingerprint: str
    """SHA-256 of the sentence of the requirement."""
    mutants: tuple[Mutant, ...]
    """The mutants that a monitor can judge, in the order of the monitor."""
    refused: tuple[tuple[Mutant, str], ...]
    """The other mutants, each with the reason."""
    monitor: Monitor


@dataclass(frozen=True)
class MutationJob:
    """The inputs of a mutation analysis, except the logs."""

    batches: tuple[MutantBatch, ...]
    declarations: Declarations
    """Declarations with the signals of the audit, so that ticks are the same as in the audit."""
    propositions: tuple[str, ...]
    """The propositions that these signals determine; others are always unknown."""
    integrity: Integrity


@dataclass(frozen=True, slots=True)
class MutantDifference:
    """Different results of a requirement and of a mutant on one run."""

    own: str
    """The verdict of the requirement."""
    other: str
    """The verdict of the mutant."""
    tick: int | None
    """The first tick at which only one of them is violated; None if only the verdicts differ."""


@dataclass(frozen=True, slots=True)
class RunSurvey:
    """The mutants that one run notices."""

    known: frozenset[str]
    """The requirements on which the run has a verdict."""
    noticed: Mapping[tuple[str, str], MutantDifference]
    """(requirement, mutant) → the difference on this run."""


def mutation_job(project: Project, plan: Plan) -> MutationJob:
    """The mutants of each requirement that the plan audits.

    Args:
        project: the project of the plan.
        plan: the plan of an audit.
    """
    audited = {claim.id for claim in plan.claims}
    requirements = {
        requirement.id: requirement
        for requirement in project.formalized
        if requirement.id in audited
    }
    batches = tuple(map(mutant_batch, requirements.values()))
    declarations = project.declarations
    assert declarations is not None, "there is a plan"
    for own in (mutant.requirement.declarations for batch in batches for mutant in batch.mutants):
        if own is not None:
            declarations = with_propositions(declarations, own.propositions, own.mistakes)
    declarations = replace(declarations, signals=plan.declarations.signals)
    names = dict.fromkeys(name for batch in batches for name in batch.monitor.PROPOSITIONS)
    known = tuple(name for name in names if _is_determined(declarations, name))
    return MutationJob(batches, declarations, known, plan.integrity)


def _is_determined(declarations: Declarations, name: str) -> bool:
    """Whether the signals determine the proposition."""
    proposition = declarations.propositions.get(name)
    return proposition is not None and declarations.signals.keys() >= {*proposition.signals}


def mutant_batch(requirement: FormalizedRequirement) -> MutantBatch:
    """The mutants of a requirement in one monitor, with the requirement itself."""
    judge: list[Mutant] = []
    refused: list[tuple[Mutant, str]] = []
    for mutant in mutants(requirement):
        why = monitors.refuse(without_probability(mutant.requirement))
        if why is None:
            judge.append(mutant)
        else:
            refused.append((mutant, why.message))
    numbered = [_called(each.requirement, f"M{n}") for n, each in enumerate(judge)]
    text = monitors.text(_called(requirement, "R"), *numbered)
    watching = load(f"{requirement.id}_mutants", text)
    return MutantBatch(
        requirement.id, requirement.fingerprint, tuple(judge), tuple(refused), watching
    )


def _called(requirement: FormalizedRequirement, id: str) -> FormalizedRequirement:
    """The requirement under another id, because ids in a monitor are distinct."""
    return replace(requirement, entry=replace(requirement.entry, id=id))


# One run ----------------------------------------------------------------------------------------


def of_run(asked: MutationJob, log: str) -> RunSurvey | Diagnostic:
    """The mutants that the run of a log notices, or why the log cannot be read.

    Args:
        asked: the mutants.
        log: path of the log.
    """
    declarations, names = asked.declarations, asked.propositions
    signals = tuple(declarations.signals)
    recording = read(log, declarations, signals, asked.integrity)
    if isinstance(recording, Diagnostic):
        return recording
    truths = trace(declarations, recording, names)
    end = Verdict(declarations.clock.end)
    known: set[str] = set()
    noticed: dict[tuple[str, str], MutantDifference] = {}
    for batch in asked.batches:
        own, *others = judgements(batch.monitor, truths, end, intact=recording.intact)
        if own.verdict != kernel.NO_DATA:
            known.add(batch.id)
        for mutant, other in zip(batch.mutants, others, strict=True):
            detected = difference(own, other)
            if detected is not None:
                noticed[batch.id, mutant.key] = detected
    return RunSurvey(frozenset(known), noticed)


def judgements(
    monitor: Monitor, truths: Trace, end: Verdict, *, intact: bool
) -> tuple[Judgement, ...]:
    """The judgement of one trace by each requirement of a monitor.

    Args:
        monitor: of any requirements; a proposition that is not in the trace is always unknown.
        truths: the trace.
        end: how an obligation is judged that is open at the end.
        intact: whether the log is whole.
    """
    ticks, cut = len(truths.timeline.times), truths.cut
    unknown = Column(0, (1 << ticks) - 1)
    columns = {name: truths.columns.get(name, unknown) for name in monitor.PROPOSITIONS}
    if cut is not None:
        cut = {name: cut.get(name) for name in columns}
    return judge(monitor, columns, cut, ticks, intact=intact, end=end)


def difference(own: Judgement, other: Judgement) -> MutantDifference | None:
    """The certain difference between the judgements of two requirements, or None.

    Args:
        own: the judgement by the requirement.
        other: the judgement by the mutant.
    """
    ticks = [*_only_in(own.outcome, other.outcome), *_only_in(other.outcome, own.outcome)]
    known = kernel.NO_DATA not in (own.verdict, other.verdict)
    if ticks or (known and own.verdict != other.verdict):
        return MutantDifference(own.verdict, other.verdict, min(ticks, default=None))
    return None


def _only_in(one: Outcome, other: Outcome) -> Iterator[int]:
    """The first tick at which `one` is certainly violated and `other` is certainly not."""
    column = _column(one.violations) & ~(_column(other.violations) | _column(other.unknown))
    if column:
        yield (column & -column).bit_length() - 1


def _column(runs: Iterable[tuple[int, int]]) -> int:
    return sum((1 << last + 1) - (1 << first) for first, last in runs)


# All runs ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MutationResult:
    """The mutants that all runs together notice."""

    runs: tuple[str, ...]
    """The runs that could be read."""
    batches: tuple[MutantBatch, ...]
    known: frozenset[str]
    """The requirements on which some run has a verdict."""
    noticed: Mapping[tuple[str, str], tuple[int, MutantDifference]]
    """(requirement, mutant) → index of the first run that notices it, and the difference."""
    diagnostics: tuple[Diagnostic, ...]
    """Diagnostics about logs that could not be read."""
    equivalent: frozenset[tuple[str, str]] = frozenset()
    """(requirement, mutant) that are proved equivalent, so that no run can notice the mutant."""

    @property
    def count(self) -> int:
        """The number of mutants, without those that are proved equivalent."""
        return sum(len(batch.mutants) + len(batch.refused) for batch in self.batches) - len(
            self.equivalent
        )

    @property
    def is_complete(self) -> bool:
        """Whether every mutant is noticed or proved equivalent."""
        return bool(self.runs) and len(self.noticed) == self.count

    def with_proofs(self, suite: Suite) -> MutationResult:
        """The result with the equivalent mutants of a test suite, for unchanged sentences."""
        known = {requirement.id: requirement.fingerprint for requirement in suite.requirements}
        current = {batch.id for batch in self.batches if known.get(batch.id) == batch.fingerprint}
        keys = {(batch.id, one.key) for batch in self.batches for one in _all(batch)}
        proved = {
            (each.requirement, each.key)
            for each in suite.mutants
            if each.outcome is MutantStatus.EQUIVALENT and each.requirement in current
        }
        return replace(self, equivalent=frozenset(proved & keys - self.noticed.keys()))


def _all(batch: MutantBatch) -> tuple[Mutant, ...]:
    return (*batch.mutants, *(mutant for mutant, _ in batch.refused))


def survey(
    asked: MutationJob, logs: Sequence[str], jobs: int, tell: Callable[[str], None]
) -> MutationResult:
    """The mutants that the runs of some logs notice, in the order of the logs.

    Args:
        asked: the mutants.
        logs: distinct files or folders.
        jobs: number of processes.
        tell: called with each log when it is done.
    """
    known: set[str] = set()
    first: dict[tuple[str, str], tuple[int, MutantDifference]] = {}
    unread: dict[int, Diagnostic] = {}
    for index, one in _each_run(asked, logs, jobs):
        tell(logs[index])
        if isinstance(one, Diagnostic):
            unread[index] = one
            continue
        known |= one.known
        for key, apart in one.noticed.items():
            if key not in first or index < first[key][0]:
                first[key] = index, apart
    runs = [index for index in range(len(logs)) if index not in unread]
    number = {index: run for run, index in enumerate(runs)}
    return MutationResult(
        tuple(name_of(logs[index]) for index in runs),
        asked.batches,
        frozenset(known),
        {key: (number[index], apart) for key, (index, apart) in first.items()},
        tuple(unread[index] for index in sorted(unread)),
    )


def _each_run(
    asked: MutationJob, logs: Sequence[str], jobs: int
) -> Iterator[tuple[int, RunSurvey | Diagnostic]]:
    """(index of a log, its result), in the order of completion."""
    files = [index for index, log in enumerate(logs) if log != STDIN]
    if STDIN in logs:  # Another process does not have this object.
        yield logs.index(STDIN), of_run(asked, STDIN)
    with closing(
        map_processes(partial(of_run, asked), [logs[index] for index in files], jobs)
    ) as done:
        for number, one in done:
            index = files[number]
            log = name_of(logs[index])
            yield index, killed_diagnostic(log, str(one)) if isinstance(one, WorkerDied) else one
