"""The result of one requirement in one run, in the form of the evidence file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isinf, isnan
from statistics import median
from typing import TypeVar, cast

from compiler.files.records import UNSET, UnsetType, decoded, plain
from compiler.files.templating import to_json
from fretc.audit.evidence.probabilities import Outcomes
from fretc.audit.evidence.samples import Reading, Surroundings, WindowSamples, WordSeries
from fretc.audit.evidence.schema import (
    Answer,
    CheckedChunks,
    Comparison,
    EvidenceDocument,
    Gap,
    Hashes,
    Health,
    Instant,
    LogFinding,
    PhaseStretch,
    PhaseVerdicts,
    Result,
    Situations,
    StateChangeRecord,
    StateWord,
    ThresholdRecord,
    TopicRecord,
    Verdict,
    Violation,
)
from fretc.audit.measurements.intervals import Moment
from fretc.audit.measurements.margins import CROSSED, Margin
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.measurements.trials import Trials
from fretc.audit.measurements.unknown_inputs import UnknownInput
from fretc.audit.measurements.violations import SampleWindow
from fretc.audit.measurements.violations import ViolationInterval as Broken
from fretc.audit.phases.by_shift import PhaseInterval, Phases
from fretc.logs.signals.enum_values import enum_value
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.samples import Topic as Read
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import as_json
from monitors.kernel import Outcome

T = TypeVar("T")
U = TypeVar("U")


@dataclass(frozen=True, slots=True)
class RunResult:
    """The result of one requirement in one run."""

    run: str
    requirement: str
    verdict: str
    reason: str
    outcome: Outcome
    start_ns: int
    end_ns: int
    first_ns: int
    """The time of the first tick in nanoseconds; without ticks, the start of the run."""
    clock: str
    answers: tuple[tuple[Moment, Moment], ...]
    """Triggers with their answers, for demands that wait for one."""
    states: tuple[tuple[Moment, str], ...]
    """The ticks at which the state changed, with the new state
    (`fretc.audit.measurements.states`)."""
    triggers: tuple[Moment, ...]
    violations: tuple[Broken, ...]
    open: tuple[Moment, ...]
    """Triggers whose demand is open at the end of the log."""
    latencies: tuple[float, ...]
    """Seconds from each trigger to its answer, in the order of the triggers."""
    propositions: Mapping[str, PropositionTally]
    """How often each proposition of the sentence was true, false and unknown."""
    margins: tuple[Margin, ...]
    """The distances of the signals to the thresholds of the propositions."""
    units: Mapping[str, str]
    """The base unit of each signal."""
    hashes: Mapping[str, str]
    """SHA-256 of the log, the sentence, the bindings and the monitor."""
    health: Health
    assumptions: tuple[str, ...]
    trials: Trials | None = None
    """The outcomes of its triggers, for a requirement with a probability."""
    unknown_inputs: tuple[UnknownInput, ...] = ()
    """When propositions were unknown, of a result without a verdict."""
    situations: Situations | None = None
    """The situations that the run showed; None: not measured."""
    phases: Phases | None = None
    """The verdict at each phase of the ticks, of the run alone for a requirement with a
    probability; None: the clock ticks by message."""


def health(recording: Recording) -> Health:
    """The integrity of the data of the run, and its diagnostics."""
    checked = recording.checked
    return Health(
        intact=recording.intact,
        size=recording.size,
        checked=CheckedChunks(
            checked.by_index,
            checked.chunks,
            checked.crc_checked,
            checked.crc_unchecked,
            checked.without_crc,
            checked.skipped,
        ),
        gaps=tuple(Gap(start, end) for start, end in recording.gaps),
        findings=tuple(map(_finding, recording.findings)),
        topics={name: _topic(topic) for name, topic in sorted(recording.topics.items())},
    )


def _finding(diagnostic: Diagnostic) -> LogFinding:
    subject = {"subject": diagnostic.subject} if diagnostic.subject else {}
    return decoded(as_json(diagnostic) | subject, LogFinding)


def _topic(topic: Read) -> TopicRecord:
    return TopicRecord(
        topic.type,
        topic.count,
        topic.first_ns,
        topic.last_ns,
        topic.longest_gap_ns,
        topic.median_period_ns,
        topic.out_of_order,
        topic.equal_stamps,
        topic.unstamped,
        topic.zero_stamps,
        topic.clock_jumps,
    )


def text(document: EvidenceDocument) -> str:
    """The text of the evidence file: equal values give equal bytes."""
    return f"{to_json(plain(document))}\n"


def as_record(evidence: RunResult) -> Result:
    """The result of one run and requirement."""
    outcome, latencies = evidence.outcome, evidence.latencies
    return Result(
        run=evidence.run,
        requirement=evidence.requirement,
        verdict=cast("Verdict", evidence.verdict),
        finite=outcome.finite,
        reason=evidence.reason,
        clock=evidence.clock,
        ticks=outcome.ticks,
        start_ns=evidence.start_ns,
        end_ns=evidence.end_ns,
        states=tuple(_state(*state) for state in evidence.states),
        answers=tuple(Answer(m.tick, m.ns, m.seconds, t.tick) for t, m in evidence.answers),
        triggers=evidence.triggers,
        violations=tuple(map(_violation, evidence.violations)),
        unknown=tuple(outcome.unknown),
        open=evidence.open,
        uncertain_ticks=tuple(outcome.uncertain),
        latencies=latencies,
        exercised=len(evidence.triggers),
        latency_median_s=round(median(latencies), 9) if latencies else None,
        latency_max_s=max(latencies, default=None),
        propositions=dict(evidence.propositions),
        thresholds=tuple(_threshold(margin, evidence.first_ns) for margin in evidence.margins),
        units=dict(evidence.units),
        fingerprints=Hashes(**evidence.hashes),
        health=evidence.health,
        assumptions=evidence.assumptions,
        outcomes=_known(evidence.trials, _outcomes),
        phases=_known(evidence.phases, phase_verdicts),
        unknown_inputs=evidence.unknown_inputs or UNSET,
        situations=_known(evidence.situations, lambda situations: situations),
    )


def unread_result(
    run: str, requirement: str, diagnostic: Diagnostic, hashes: Mapping[str, str]
) -> Result:
    """The result of a run whose log could not be read: no data."""
    health = Health(False, None, None, (), (_finding(diagnostic),), {})
    return unjudged_result(run, requirement, diagnostic.message, hashes, health)


def unjudged_result(
    run: str, requirement: str, reason: str, hashes: Mapping[str, str], health: Health
) -> Result:
    """The result of a requirement by which no log can be evaluated: no data."""
    return Result(
        run=run,
        requirement=requirement,
        verdict="no data",
        finite=None,
        reason=reason,
        clock="",
        ticks=0,
        start_ns=None,
        end_ns=None,
        states=(),
        answers=(),
        triggers=(),
        violations=(),
        unknown=(),
        open=(),
        uncertain_ticks=(),
        latencies=(),
        exercised=0,
        latency_median_s=None,
        latency_max_s=None,
        propositions={},
        thresholds=(),
        units={},
        fingerprints=Hashes(**hashes),
        health=health,
        assumptions=(),
    )


def _state(at: Moment, word: str) -> StateChangeRecord:
    return StateChangeRecord(at.tick, at.ns, at.seconds, cast("StateWord", word))


def _known(value: T | None, write: Callable[[T], U]) -> U | UnsetType:
    return UNSET if value is None else write(value)


def _outcomes(trials: Trials) -> Outcomes:
    return Outcomes(trials.answered, trials.failed, trials.open)


def phase_verdicts(phases: Phases) -> PhaseVerdicts:
    """The verdict at each phase, as evidence records it."""
    return PhaseVerdicts(
        phases.period,
        phases.declared,
        phases.exact,
        phases.nearest,
        tuple(
            PhaseStretch(s.first, s.last, cast("Verdict | None", s.verdict))
            for s in phases.stretches
        ),
    )


def phases_of(record: PhaseVerdicts) -> Phases:
    """The verdict at each phase, from its record."""
    stretches = (
        PhaseInterval(stretch.first_ns, stretch.last_ns, stretch.verdict)
        for stretch in record.stretches
    )
    return Phases(record.period_ns, record.declared_ns, tuple(stretches))


def _threshold(margin: Margin, first_ns: int) -> ThresholdRecord:
    threshold, near = margin.threshold, margin.nearest_ns
    return ThresholdRecord(
        proposition=threshold.proposition,
        signal=threshold.text,
        operator=threshold.operator,
        bound=threshold.bound,
        unit=threshold.unit,
        least=_reading(margin.least),
        greatest=_reading(margin.greatest),
        comparison=_comparison(margin.comparison),
        margin=margin.distance,
        nearest=None if near is None else Instant(near, round((near - first_ns) / 1e9, 9)),
    )


def _comparison(state: bool | str | None) -> Comparison | None:
    if isinstance(state, str):
        assert state == CROSSED
        return "crossed"
    return None if state is None else "true" if state else "false"


def _reading(value: float | None) -> Reading:
    """A number that may be unknown (null) or infinite, in the form of JSON."""
    if value is None or isnan(value):
        return None
    if isinf(value):
        return "+inf" if value > 0 else "-inf"
    return value


def _violation(broken: Broken) -> Violation:
    first, last = broken.first, broken.last
    return Violation(
        first_tick=first.tick,
        last_tick=last.tick,
        start_ns=first.ns,
        end_ns=last.ns,
        start_s=first.seconds,
        end_s=last.seconds,
        trigger=broken.trigger,
        deadline=broken.deadline,
        missing=broken.missing,
        values=dict(broken.values),
        surroundings=_surroundings(broken.window) if broken.window else None,
        beliefs=broken.beliefs or UNSET,
    )


def _surroundings(window: SampleWindow) -> Surroundings:
    numbers = {name: _series(each) for name, each in window.samples.items() if not each.words}
    words = {name: _words(each) for name, each in window.samples.items() if each.words}
    return Surroundings(window.start_ns, window.end_ns, numbers, words or UNSET)


def _words(samples: Samples) -> WordSeries:
    words = (enum_value(float(value), samples.words) for value in samples.values)
    return WordSeries(tuple(samples.times.tolist()), tuple(words))


def _series(samples: Samples) -> WindowSamples:
    return WindowSamples(tuple(samples.times.tolist()), tuple(map(_reading, samples.base.tolist())))
