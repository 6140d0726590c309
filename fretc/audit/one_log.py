"""The audit of one log: run the monitors on its recording and collect the evidence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from functools import cache
from statistics import median

import numpy as np

from compiler.situations.situations import Situation
from compiler.situations.thresholds import ThresholdPosition
from fretc.audit.evidence.schema import Health, Situations
from fretc.audit.evidence.verdicts import of_kind
from fretc.audit.evidence.writer import RunResult, health
from fretc.audit.measurements.intervals import Moment, interval_words
from fretc.audit.measurements.judgement import WITHOUT_VIOLATION, judge
from fretc.audit.measurements.margins import Margin, margins, worst
from fretc.audit.measurements.situations import Near, nowhere_known, situation_ticks
from fretc.audit.measurements.states import states
from fretc.audit.measurements.tallies import tally
from fretc.audit.measurements.trials import Count, Trials
from fretc.audit.measurements.unknown_inputs import unknown_inputs, without_brackets
from fretc.audit.measurements.violations import BoundBeliefs, DemandText, violations
from fretc.audit.phases.by_shift import Phases, phases
from fretc.logs import log_diagnostics
from fretc.logs.sample_fingerprint import fingerprint
from fretc.logs.signals.computed import computed_samples
from fretc.logs.signals.enum_values import UnmappedSamples, shown
from fretc.logs.signals.rates import late_topics, slow_topics
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.signals import blind_zones
from fretc.logs.signals.traces import Trace, WholeTicks, timeline, trace
from fretc.logs.watch_records import clock_text
from fretish import expressions as e
from fretish.bindings.amounts import duration, scaled, seconds, shared_unit, value
from fretish.bindings.amounts import margin as margin_text
from fretish.bindings.declarations import Declarations, MeasuredSignal, Proposition, Signal
from fretish.classes.frozen import dataclass
from fretish.clock import in_words
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.printer import expression
from fretish.reading.caching import cache_by_identity
from fretish.units import base_name
from monitors import kernel
from monitors.kernel import Column, Monitor
from monitors.kernel.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class MonitoredRequirement:
    """A requirement with its monitor, and the hashes of the inputs of the monitor."""

    monitor: Monitor
    hashes: Mapping[str, str]
    demand: DemandText = field(default_factory=DemandText)
    count: Count | None = None
    """The counter of trigger outcomes, for a requirement with a probability."""
    counted: tuple[str, ...] = ()
    """The propositions that `count` reads; the monitor may need fewer."""
    situations: tuple[Situation, ...] = ()
    """The situations to look for in runs; empty: they are not measured."""
    is_assumption: bool = False
    """Whether it demands something of the environment."""
    beliefs: Mapping[str, str] = field(default_factory=dict)
    """Proposition → the belief of an agent, where the names differ."""

    @property
    def propositions(self) -> tuple[str, ...]:
        """All propositions that the requirement needs, each once."""
        return _needed(self)


@cache_by_identity
def _needed(requirement: MonitoredRequirement) -> tuple[str, ...]:
    return tuple(dict.fromkeys((*requirement.monitor.PROPOSITIONS, *requirement.counted)))


@cache_by_identity
def _assumed(declarations: Declarations, requirement: MonitoredRequirement) -> tuple[str, ...]:
    return declarations.restricted_to(requirement.propositions).assumptions


@cache_by_identity
def signals_of(declarations: Declarations, propositions: Sequence[str]) -> tuple[str, ...]:
    """The names of the signals that the propositions read, in the order of their first use."""
    return tuple(
        dict.fromkeys(
            name
            for proposition in propositions
            for name in declarations.propositions[proposition].signals
        )
    )


@cache_by_identity
def _computed(declarations: Declarations, propositions: Sequence[str]) -> tuple[str, ...]:
    """The names of the computed signals of the propositions, in the order of their first use."""
    return tuple(
        dict.fromkeys(
            name
            for proposition in propositions
            for name in declarations.propositions[proposition].calculations
        )
    )


def examined(
    recording: Recording, declarations: Declarations, propositions: Sequence[str]
) -> Recording:
    """The recording with further diagnostics about the signals that the propositions read.

    They are about obstacles that sensors cannot detect, slow topics, and samples that are not a
    truth value.
    """
    signals = signals_of(declarations, propositions)
    slow = slow_topics(declarations, recording, signals)
    ticks = timeline(declarations, recording).times if recording.late else np.zeros(0, np.int64)
    late = late_topics(declarations, recording, signals, ticks)
    blind = (
        finding
        for name in propositions
        for finding in blind_zones(declarations.propositions[name], declarations, recording.nearest)
    )
    expressions = [declarations.propositions[name].expression for name in propositions]
    flags = dict.fromkeys(name.id for expression in expressions for name in e.truths(expression))
    untrue = (_untrue(declarations.signals[name], recording) for name in flags)
    all_findings = (*recording.findings, *filter(None, untrue), *blind, *slow, *late)
    return replace(recording, findings=all_findings)


def _untrue(signal: Signal, recording: Recording) -> Diagnostic | None:
    """F424 if samples of a signal that is read as a truth value are neither 0 nor 1."""
    samples = recording.samples.get(signal.name)
    if samples is None:
        return None
    values = samples.values
    (rows,) = np.nonzero(~np.isnan(values) & (values != 0) & (values != 1))
    if not len(rows):
        return None
    foreign = UnmappedSamples(len(rows), int(rows[0]), shown(values[rows[0]]))
    after = int(samples.times[rows[0]]) - recording.start_ns
    return log_diagnostics.no_truth(signal, foreign, len(values), after)


def audit(
    recording: Recording,
    declarations: Declarations,
    requirements: Sequence[MonitoredRequirement],
) -> tuple[RunResult, ...]:
    """The result of one run for each requirement, in their order.

    Args:
        recording: the recording with all signals of all the monitors' propositions.
        declarations: every proposition of the monitors is declared.
        requirements: the requirements with their monitors.
    """
    names = dict.fromkeys(name for requirement in requirements for name in requirement.propositions)
    truths = trace(declarations, recording, tuple(names))
    margins_of = {
        name: margins(
            declarations.propositions[name], declarations, recording, truths.timeline.times
        )
        for name in names
    }
    near = _near(recording, declarations, len(truths.timeline.times))
    phases_of = phases(
        declarations, recording, [requirement.monitor for requirement in requirements]
    )
    run_health, at = health(recording), _moments(truths.timeline)
    evidence = [
        _evidence(recording, declarations, truths, at, margins_of, near, requirement, run_health)
        for requirement in requirements
    ]
    return tuple(
        _of_kind(_phased(result, phases_of.get(result.requirement)), requirement)
        for result, requirement in zip(evidence, requirements, strict=True)
    )


def _of_kind(evidence: RunResult, requirement: MonitoredRequirement) -> RunResult:
    """The result, with the verdict of an assumption if it is one."""
    is_assumption = requirement.is_assumption
    return replace(evidence, verdict=of_kind(evidence.verdict, is_assumption=is_assumption))


def _phased(evidence: RunResult, phases: Phases | None) -> RunResult:
    """The results, with the verdicts of the run at other phases of the ticks."""
    if phases is None:
        return evidence
    probabilistic = evidence.trials is not None
    assert probabilistic or phases.verdict == evidence.verdict, "two verdicts at one phase"
    alone = "in this run alone, " if probabilistic else ""
    addition = f"; {alone}{phases.text}" if phases.text else ""
    return replace(evidence, phases=phases, reason=f"{evidence.reason}{addition}")


def _evidence(
    recording: Recording,
    declarations: Declarations,
    truths: Trace,
    at: Callable[[int], Moment],
    margins_of: Mapping[str, tuple[Margin, ...]],
    near: Near,
    requirement: MonitoredRequirement,
    health: Health,
) -> RunResult:
    monitor = requirement.monitor
    columns = {name: truths.columns[name] for name in requirement.propositions}
    ticks = len(truths.timeline.times)
    (judgement,) = judge(
        monitor,
        columns,
        truths.cut,
        ticks,
        intact=recording.intact,
        end=Verdict(declarations.clock.end),
    )
    outcome = judgement.outcome
    signals = signals_of(declarations, requirement.propositions)
    computed = computed_samples(
        _computed(declarations, requirement.propositions), declarations, recording
    )
    every = replace(recording, samples={**recording.samples, **computed}) if computed else recording
    signals = (*signals, *computed)
    pairs = outcome.answers[:]  # the tuple is made, which `states` reads again
    answers = tuple((at(t), at(k)) for t, k in pairs)
    evidence = RunResult(
        run=recording.name,
        requirement=monitor.REQUIREMENTS[0].id,
        verdict=judgement.verdict,
        reason="",
        outcome=outcome,
        start_ns=recording.start_ns,
        end_ns=recording.end_ns,
        first_ns=int(truths.timeline.times[0]) if ticks else recording.start_ns,
        clock=clock_text(declarations.clock),
        answers=answers,
        states=tuple((at(tick), state) for tick, state in states(outcome)),
        triggers=tuple(at(t) for t in outcome.triggers),
        violations=violations(
            outcome,
            requirement.demand,
            monitor.REQUIREMENTS[0].deadline_ticks,
            at,
            every,
            signals,
            BoundBeliefs(columns, requirement.beliefs),
        ),
        open=tuple(at(t) for t, _ in outcome.open),
        latencies=tuple(round(k.seconds - t.seconds, 9) for t, k in answers),
        propositions={name: tally(column, ticks) for name, column in columns.items()},
        margins=tuple(margin for name in columns for margin in margins_of[name]),
        units={name: base_name(declarations.measured[name].unit.dimension) for name in signals},
        hashes={**hash_of(recording), **requirement.hashes},
        health=health,
        assumptions=_assumed(declarations, requirement),
        situations=_situations(requirement, columns, ticks, near, at),
        unknown_inputs=unknown_inputs(columns, at, declarations, recording)
        if judgement.verdict == kernel.NO_DATA
        else (),
    )
    evidence = replace(evidence, reason=_reason(evidence, recording, declarations))
    if requirement.count is None:
        return evidence
    evidence = replace(evidence, hashes={**evidence.hashes, **hash_of_messages(recording)})
    return _counted(evidence, _trials(requirement.count, columns, truths))


def _near(recording: Recording, declarations: Declarations, ticks: int) -> Near:
    """The positions of the numbers of the recording; the last sample of a tick counts."""
    nowhere = nowhere_known(ticks)

    @cache
    def named(name: str, place: ThresholdPosition) -> Column:
        proposition = Proposition(name, place.near)
        if not declarations.signals.keys() >= {*proposition.signals}:
            return nowhere(place)
        alone = replace(declarations, propositions={name: proposition})
        return trace(alone, recording, (name,)).columns[name]

    return lambda place: named(expression(place.near), place)


def _situations(
    requirement: MonitoredRequirement,
    columns: Mapping[str, Column],
    ticks: int,
    near: Near,
    at: Callable[[int], Moment],
) -> Situations | None:
    if not requirement.situations:
        return None
    occurrences = [*situation_ticks(requirement.situations, columns, ticks, near)]
    return Situations(
        {each.key: at(each.seen) for each in occurrences if each.seen is not None},
        {each.key: at(each.perhaps) for each in occurrences if each.perhaps is not None},
    )


def _counted(evidence: RunResult, trials: Trials) -> RunResult:
    """The result with its triggers counted, if one run alone decides nothing.

    A trigger may have failed although the monitor still waits: `finally` demands nothing of an
    endless run, so its monitor gives a verdict only at the end.
    """
    if evidence.verdict == kernel.VACUOUS:
        return replace(evidence, trials=trials)
    if evidence.verdict == kernel.NO_DATA:
        return replace(evidence, trials=trials, reason=f"{evidence.reason}; {trials}")
    reason = f"{trials}: judged over all runs"
    return replace(evidence, trials=trials, verdict=kernel.INCONCLUSIVE, reason=reason)


def _trials(count: Count, columns: Mapping[str, Column], truths: Trace) -> Trials:
    ticks = len(truths.timeline.times)
    of_whole_ticks = count(columns, ticks)
    if truths.cut is None or not ticks:
        return of_whole_ticks
    longer = {name: column.followed(truths.cut[name], ticks) for name, column in columns.items()}
    return of_whole_ticks.before(count(longer, ticks + 1))


def hash_of(recording: Recording) -> Mapping[str, str]:
    """SHA-256 of the log, by the kind of its content."""
    return {"log" if recording.checked.hashed else "log_summary": recording.sha256}


def hash_of_messages(recording: Recording) -> Mapping[str, str]:
    """SHA-256 of all messages that were read, if there are any."""
    messages = fingerprint(recording)
    return {} if messages is None else {"messages": messages}


def _moments(timeline: WholeTicks) -> Callable[[int], Moment]:
    """The moment of each tick, cached for triggers, answers and states."""
    times: list[int] = timeline.times.tolist()

    @cache
    def at(tick: int) -> Moment:
        return Moment(tick, times[tick], round((times[tick] - times[0]) / 1e9, 9))

    return at


def _reason(evidence: RunResult, recording: Recording, declarations: Declarations) -> str:
    """The reason of the verdict, in one sentence."""
    outcome = evidence.outcome
    match evidence.verdict:
        case kernel.VIOLATED:
            return _broken(evidence)
        case kernel.NO_DATA:
            return _unknown(evidence, recording, declarations)
        case kernel.INCONCLUSIVE if evidence.outcome.verdict in WITHOUT_VIOLATION:
            return "what came after the last whole tick leaves it open"
        case kernel.INCONCLUSIVE:
            last = evidence.open[-1] if evidence.open else None
            since = f" since {seconds(last.seconds)}" if last else ""
            return f"{_times(len(evidence.open), 'demand')} open at the end of the log{since}"
        case kernel.VACUOUS:
            return f"never triggered in {outcome.ticks} ticks"
        case _:
            return (
                f"held, {_times(len(evidence.triggers), 'trigger')}{_latency(evidence)}"
                f"{_margin(evidence, declarations.measured)}"
            )


def _broken(evidence: RunResult) -> str:
    first = evidence.violations[0]
    trigger = f", triggered at {seconds(first.trigger.seconds)}" if first.trigger else ""
    return (
        f"{interval_words(first.first, first.last, evidence.clock)}{trigger}"
        f"{_more(len(evidence.violations))}"
    )


def _more(count: int) -> str:
    return f"; the first of {count:,} intervals" if count > 1 else ""


def _unknown(evidence: RunResult, recording: Recording, declarations: Declarations) -> str:
    of_others = {s.span for s in declarations.signals.values() if s.name not in evidence.units}
    errors = [
        finding.message
        for finding in recording.findings
        if finding.is_error and (finding.span is None or finding.span not in of_others)
    ]
    if errors:
        return errors[0]
    if not recording.intact:
        return "the log is damaged: the lost part may contain a violation"
    runs = evidence.outcome.unknown
    ticks = sum(last - first + 1 for first, last in runs)
    if not evidence.outcome.ticks:
        return "no whole tick of the clock lies within the log"
    if not runs:
        return f"unknown where it matters{_of_whom(evidence)}"
    return (
        f"undecided at {_share(ticks, evidence.outcome.ticks)}, because inputs are unknown"
        f"{_of_whom(evidence)}{_remedy(evidence, recording, declarations)}"
    )


def _share(ticks: int, of: int) -> str:
    """`5 of 608 ticks (0.822 %)`."""
    return f"{ticks:,} of {_times(of, 'tick')} ({value(100 * ticks / of, '%')})"


def _remedy(evidence: RunResult, recording: Recording, declarations: Declarations) -> str:
    """What to change in the bindings where samples were too old; empty: they were not."""
    old = dict.fromkeys(each.signal for each in evidence.unknown_inputs if each.cause == "too old")
    for name in old:
        signal = declarations.signals[name]
        topic = recording.topics.get(signal.path.topic)
        if signal.max_age is not None and topic is not None and topic.longest_gap_ns:
            gap = duration(topic.longest_gap_ns / 1e9)
            return (
                f"; `max_age` is {in_words(signal.max_age)}, the longest gap {gap}: raise it only "
                "if a sample may count that long"
            )
    return ""


def _of_whom(evidence: RunResult) -> str:
    """The propositions that were unknown at some tick."""
    parts = [
        f"`{without_brackets(name)}` at {_times(tally.unknown, 'tick')}"
        for name, tally in evidence.propositions.items()
        if tally.unknown
    ]
    intervals = sorted(evidence.unknown_inputs, key=lambda one: one.first_tick - one.last_tick)
    longest = [one.in_words(evidence.clock) for one in intervals[:1]]
    several = [", ".join(parts), *(f"the longest: {one}" for one in longest)]
    return f": {'; '.join(longest if len(intervals) == 1 else several)}" if parts else ""


def _latency(evidence: RunResult) -> str:
    latencies = evidence.latencies
    if not latencies:
        return ""
    if len(latencies) == 1:
        return f", answered after {duration(latencies[0])}"
    middle, longest = duration(median(latencies)), duration(max(latencies))
    return f", answered after {middle} (median), {longest} (longest)"


def _margin(evidence: RunResult, signals: Mapping[str, MeasuredSignal]) -> str:
    """The threshold that was nearest, as a fraction of its bound; crossed thresholds have none."""
    least = worst(evidence.margins)
    if least is None:
        return ""
    unit, factor = shared_unit(least.threshold.text, least.threshold.unit, signals)
    assert least.distance is not None, "a margin that has a share has a distance"
    bound = scaled(least.threshold.bound, factor)
    distance = margin_text(scaled(least.distance, factor), unit, bound)
    return f", least margin {distance} ({expression(least.threshold.comparison)})"


def _times(count: int, one: str, many: str = "") -> str:
    return f"{count} {one if count == 1 else many or one + 's'}"
