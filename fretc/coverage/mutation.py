"""Which wrong requirements recorded runs would have shown: mutants judged beside the right one.

A run notices a mutant where the two verdicts on it differ, both of them known, or where one is
certainly violated at a tick at which the other certainly is not. What is unknown notices nothing.
All mutants of a requirement are one monitor, judged over the very columns of its audit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial

from compiler.formalization.formalized import FormalizedRequirement, plain
from compiler.formalization.resolution import extended
from compiler.project.folder import Project
from compiler.situations.mutants import Mutant, mutants
from compiler.targets.python import monitor as monitors
from fretc.audit.measurements.judgement import Judgement, each_judged
from fretc.audit.plan import Plan
from fretc.audit.pool import WorkerDied, each, was_killed
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.traces import Trace, trace
from fretc.logs.storage.log_names import STDIN, name_of
from fretc.testing.suite import MutantStatus, Suite
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic
from monitors import kernel
from monitors.kernel import Column, Monitor, Outcome
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


@dataclass(frozen=True)
class MutantBatch:
    """A requirement and its mutants, as one monitor: the requirement is the first in it."""

    id: str
    fingerprint: str
    """SHA-256 of its sentence."""
    mutants: tuple[Mutant, ...]
    """Those that a monitor can judge, in its order."""
    refused: tuple[tuple[Mutant, str], ...]
    """The others, and why."""
    monitor: Monitor


@dataclass(frozen=True)
class MutationJob:
    """All that is needed beside a log to tell which mutants its run notices."""

    suspects: tuple[MutantBatch, ...]
    declarations: Declarations
    """With the signals of the audit, so that its ticks are those of the audit."""
    propositions: tuple[str, ...]
    """Those of which these signals tell the truth; others are unknown throughout."""
    integrity: Integrity


@dataclass(frozen=True, slots=True)
class Difference:
    """What a run says of a requirement and of a mutant."""

    own: str
    """The verdict of the requirement."""
    other: str
    """That of the mutant."""
    tick: int | None
    """The first tick at which only one of them is violated; None: the verdicts alone differ."""


@dataclass(frozen=True, slots=True)
class RunSurvey:
    """What one run tells apart."""

    known: frozenset[str]
    """The requirements on which it has a verdict."""
    noticed: Mapping[tuple[str, str], Difference]
    """Requirement and mutant → how it tells them apart."""


def inquiry(project: Project, plan: Plan) -> MutationJob:
    """The mutants of each requirement that the plan audits.

    Args:
        project: that the plan is of.
        plan: of an audit.
    """
    audited = {claim.id for claim in plan.claims}
    requirements = {
        requirement.id: requirement
        for requirement in project.formalized
        if requirement.id in audited
    }
    found = tuple(map(suspects, requirements.values()))
    declarations = project.declarations
    assert declarations is not None, "there is a plan"
    for own in (mutant.requirement.declarations for one in found for mutant in one.mutants):
        if own is not None:
            declarations = extended(declarations, own.propositions, own.mistakes)
    declarations = replace(declarations, signals=plan.declarations.signals)
    names = dict.fromkeys(name for one in found for name in one.monitor.PROPOSITIONS)
    known = tuple(name for name in names if _is_told(declarations, name))
    return MutationJob(found, declarations, known, plan.integrity)


def _is_told(declarations: Declarations, name: str) -> bool:
    """Whether the signals tell its truth."""
    proposition = declarations.propositions.get(name)
    return proposition is not None and declarations.signals.keys() >= {*proposition.signals}


def suspects(requirement: FormalizedRequirement) -> MutantBatch:
    """The mutants of a requirement in one monitor, with the requirement itself."""
    judged: list[Mutant] = []
    refused: list[tuple[Mutant, str]] = []
    for mutant in mutants(requirement):
        why = monitors.refuse(plain(mutant.requirement))
        if why is None:
            judged.append(mutant)
        else:
            refused.append((mutant, why.message))
    numbered = [_called(each.requirement, f"M{n}") for n, each in enumerate(judged)]
    text = monitors.text(_called(requirement, "R"), *numbered)
    watching = load(f"{requirement.id}_mutants", text)
    return MutantBatch(
        requirement.id, requirement.fingerprint, tuple(judged), tuple(refused), watching
    )


def _called(requirement: FormalizedRequirement, id: str) -> FormalizedRequirement:
    """The requirement under another id: in a monitor each has its own."""
    return replace(requirement, entry=replace(requirement.entry, id=id))


# One run ----------------------------------------------------------------------------------------


def of_run(asked: MutationJob, log: str) -> RunSurvey | Diagnostic:
    """What the run of a log tells apart, or why the log cannot be read.

    Args:
        asked: the mutants.
        log: its path.
    """
    declarations, names = asked.declarations, asked.propositions
    signals = tuple(declarations.signals)
    recording = read(log, declarations, signals, asked.integrity)
    if isinstance(recording, Diagnostic):
        return recording
    truths = trace(declarations, recording, names)
    end = Verdict(declarations.clock.end)
    known: set[str] = set()
    noticed: dict[tuple[str, str], Difference] = {}
    for one in asked.suspects:
        own, *others = judgements(one.monitor, truths, end, intact=recording.intact)
        if own.verdict != kernel.NO_DATA:
            known.add(one.id)
        for mutant, other in zip(one.mutants, others, strict=True):
            found = difference(own, other)
            if found is not None:
                noticed[one.id, mutant.key] = found
    return RunSurvey(frozenset(known), noticed)


def judgements(
    monitor: Monitor, truths: Trace, end: Verdict, *, intact: bool
) -> tuple[Judgement, ...]:
    """Those of one trace by each requirement of a monitor.

    Args:
        monitor: of any requirements; a proposition that the trace lacks is unknown throughout.
        truths: the trace.
        end: what a demand is that is open at the end.
        intact: whether the log is whole.
    """
    ticks, cut = len(truths.timeline.times), truths.cut
    unknown = Column(0, (1 << ticks) - 1)
    columns = {name: truths.columns.get(name, unknown) for name in monitor.PROPOSITIONS}
    if cut is not None:
        cut = {name: cut.get(name) for name in columns}
    return each_judged(monitor, columns, cut, ticks, intact=intact, end=end)


def difference(own: Judgement, other: Judgement) -> Difference | None:
    """How one run tells two requirements apart for certain; None: it does not.

    Args:
        own: the judgement by one.
        other: that by the other.
    """
    ticks = [*_only_in(own.outcome, other.outcome), *_only_in(other.outcome, own.outcome)]
    known = kernel.NO_DATA not in (own.verdict, other.verdict)
    if ticks or (known and own.verdict != other.verdict):
        return Difference(own.verdict, other.verdict, min(ticks, default=None))
    return None


def _only_in(one: Outcome, other: Outcome) -> Iterator[int]:
    """The first tick at which one is certainly violated and the other certainly is not."""
    column = _column(one.violations) & ~(_column(other.violations) | _column(other.unknown))
    if column:
        yield (column & -column).bit_length() - 1


def _column(runs: Iterable[tuple[int, int]]) -> int:
    return sum((1 << last + 1) - (1 << first) for first, last in runs)


# All runs ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MutationResult:
    """What all runs tell apart."""

    runs: tuple[str, ...]
    """Those that could be read."""
    suspects: tuple[MutantBatch, ...]
    known: frozenset[str]
    """The requirements on which some run has a verdict."""
    noticed: Mapping[tuple[str, str], tuple[int, Difference]]
    """Requirement and mutant → the first run that tells them apart, and how."""
    diagnostics: tuple[Diagnostic, ...]
    """Why others could not."""
    equivalent: frozenset[tuple[str, str]] = frozenset()
    """Requirement and mutant that are proved to say the same: no run could notice that one."""

    @property
    def count(self) -> int:
        """Of the mutants that say something else, as far as is known."""
        return sum(len(each.mutants) + len(each.refused) for each in self.suspects) - len(
            self.equivalent
        )

    @property
    def is_complete(self) -> bool:
        """Whether every mutant is noticed that says something else."""
        return bool(self.runs) and len(self.noticed) == self.count

    def with_proofs(self, suite: Suite) -> MutationResult:
        """The same with what tests have proved, of requirements whose sentence they are of."""
        known = {each.id: each.fingerprint for each in suite.requirements}
        current = {each.id for each in self.suspects if known.get(each.id) == each.fingerprint}
        keys = {(each.id, one.key) for each in self.suspects for one in _all(each)}
        proved = {
            (each.requirement, each.key)
            for each in suite.mutants
            if each.outcome is MutantStatus.EQUIVALENT and each.requirement in current
        }
        return replace(self, equivalent=frozenset(proved & keys - self.noticed.keys()))


def _all(suspects: MutantBatch) -> tuple[Mutant, ...]:
    return (*suspects.mutants, *(mutant for mutant, _ in suspects.refused))


def survey(
    asked: MutationJob, logs: Sequence[str], jobs: int, tell: Callable[[str], None]
) -> MutationResult:
    """What the runs of some logs tell apart, in the order of the logs.

    Args:
        asked: the mutants.
        logs: files or folders, each once.
        jobs: processes.
        tell: is called with each log when it is done.
    """
    known: set[str] = set()
    first: dict[tuple[str, str], tuple[int, Difference]] = {}
    unread: dict[int, Diagnostic] = {}
    for place, one in _each_run(asked, logs, jobs):
        tell(logs[place])
        if isinstance(one, Diagnostic):
            unread[place] = one
            continue
        known |= one.known
        for key, apart in one.noticed.items():
            if key not in first or place < first[key][0]:
                first[key] = place, apart
    runs = [place for place in range(len(logs)) if place not in unread]
    number = {place: run for run, place in enumerate(runs)}
    return MutationResult(
        tuple(name_of(logs[place]) for place in runs),
        asked.suspects,
        frozenset(known),
        {key: (number[place], apart) for key, (place, apart) in first.items()},
        tuple(unread[place] for place in sorted(unread)),
    )


def _each_run(
    asked: MutationJob, logs: Sequence[str], jobs: int
) -> Iterator[tuple[int, RunSurvey | Diagnostic]]:
    """Each log, as it is done, by its place."""
    files = [place for place, log in enumerate(logs) if log != STDIN]
    if STDIN in logs:  # another process does not have it
        yield logs.index(STDIN), of_run(asked, STDIN)
    with closing(each(partial(of_run, asked), [logs[place] for place in files], jobs)) as done:
        for number, one in done:
            place = files[number]
            log = name_of(logs[place])
            yield place, was_killed(log, str(one)) if isinstance(one, WorkerDied) else one
