"""The results of one requirement, run by run, and the reasons why it is not shown."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from itertools import groupby
from statistics import median

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.schema import Moment, Result, ThresholdRecord, Violation
from fretc.audit.evidence.verdicts import (
    NOT_EXERCISED,
    RETIRED,
    SUSPECT,
    UNFORMALIZED,
    severity,
)
from fretc.audit.measurements.intervals import end_s, interval_length
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment, ProbabilityAudit, SingleAudit
from fretc.report.model.causes import causes
from fretc.report.model.results import (
    Latency,
    Listing,
    ResultHead,
    ResultRow,
    ResultView,
    ThresholdView,
    ViolationView,
)
from fretc.report.model.suspicions import since_review
from fretc.report.pictures.first_tick import reading
from fretc.report.pictures.histograms import seconds_allowed
from fretc.report.pictures.timeline import answered, timelines
from fretc.report.sections.runs import AuditedFile, RunKey, run_key
from fretish import syntax
from fretish.bindings.amounts import exact
from fretish.bindings.amounts import margin as margin_text
from fretish.bindings.declarations import Declarations
from fretish.clock import Clock
from fretish.meaning import span
from monitors import kernel

LISTED = 100
"""Maximum number of listed violations, open obligations and unknown intervals."""
_WAITS = 5
"""Maximum number of listed waits of a result."""
_NAMED = 10
"""Maximum number of runs among the reasons why a requirement is not shown."""


def result_rows(
    assessment: Assessment, runs: Mapping[RunKey, AuditedFile]
) -> tuple[ResultRow, ...]:
    """A row for each audit of a requirement, in the order of the runs."""
    return tuple(
        _row(audit, assessment, number, runs[run_key(audit.result)])
        for number, audit in enumerate(assessment.reviewed_audits, 1)
    )


def _row(audit: SingleAudit, assessment: Assessment, number: int, run: AuditedFile) -> ResultRow:
    result = audit.result
    return ResultRow(
        anchor=f"{assessment.anchor.replace('req-', 'result-', 1)}.{number}",
        run=run.anchor,
        run_label=run.name,
        run_file=phrases.place(result.run),
        mark=audit.mark,
        suspicions=audit.suspicions,
        reason=result.reason,
        triggers=result.triggers,
        place=audit.place,
        number=number,
        requirement=assessment.id,
        section=assessment.anchor,
        ticks=result.ticks,
        answers=result.answers,
        at_once=result.at_once,
        open=result.open,
        unknown=result.unknown,
        violations_total=result.violations,
        latency_median_s=result.latency_median_s,
        latency_max_s=result.latency_max_s,
    )


def result_view(
    result: Result, row: ResultRow, assessment: Assessment, declared: Declarations | None
) -> ResultView:
    """The view of a result.

    Args:
        result: the result, in declared units.
        row: the row of the same result.
        assessment: the assessment of its requirement.
        declared: the bindings.
    """
    # The present clock and age limits do not apply to a result of other bindings.
    is_stale = assessment.audits[row.number - 1].is_stale
    bindings, requirement = (None, None) if is_stale else (declared, assessment.requirement)
    tick, ages = _tick(result, bindings.clock if bindings else None), _ages(bindings)
    return ResultView(
        **{each.name: getattr(row, each.name) for each in fields(ResultHead)},
        exercised=_exercised(result),
        latency=_latency(result, assessment.requirement),
        unanswered=_unanswered(result, assessment.requirement),
        thresholds=tuple(map(_threshold, result.thresholds)),
        violations=tuple(
            _violation(v, result, ages, requirement) for v in result.violations[:LISTED]
        ),
        violations_total=len(result.violations),
        open=_open(result),
        unknown=_unknown(result),
        unknown_inputs=_unknown_inputs(result),
        timelines=timelines(result, tick, ages, requirement),
    )


def _tick(result: Result, clock: Clock | None) -> float:
    """Length of a tick in seconds; an average if ticks are messages or the clock is unknown."""
    if clock is not None and clock.period:
        return clock.period / 1e9
    if result.start_ns is None or result.end_ns is None or result.end_ns <= result.start_ns:
        return 1.0
    return (result.end_ns - result.start_ns) / 1e9 / max(1, result.ticks)


def _ages(declared: Declarations | None) -> dict[str, float]:
    """The age limit of each signal that has one, in seconds."""
    signals = declared.signals.values() if declared else ()
    return {signal.name: signal.max_age / 1e9 for signal in signals if signal.max_age}


def _exercised(result: Result) -> str:
    ticks = phrases.times(result.ticks, "tick")
    if not result.triggers:
        return f"never triggered in {ticks}"
    stretches = len(_stretches(result.triggers))
    return (
        f"triggered at {phrases.whole(len(result.triggers))} of {ticks}, "
        f"in {phrases.times(stretches, 'stretch', 'stretches')}"
    )


def _stretches(moments: Iterable[Moment]) -> list[list[Moment]]:
    """The moments in order, in groups of neighbouring ticks."""
    groups: list[list[Moment]] = []
    for moment in sorted(moments, key=lambda m: m.tick):
        if groups and moment.tick - groups[-1][-1].tick <= 1:
            groups[-1].append(moment)
        else:
            groups.append([moment])
    return groups


# Latency ---------------------------------------------------------------------------------------


def _latency(result: Result, requirement: FormalizedRequirement | None) -> Latency | None:
    if not result.latencies:
        return None
    longest = max(result.latencies)
    bounds = [bound for bound in [seconds_allowed(requirement)] if bound is not None]
    at_once = sum(latency <= 0 for latency in result.latencies)
    answers = phrases.times(len(result.latencies), "trigger")
    unknown = len(result.uncertain - {moment.tick for moment in result.open})
    since = next((m for m, latency in answered(result) if latency == longest), None)
    after = f", after the trigger at {phrases.seconds(since.seconds)}" if since and longest else ""
    return Latency(
        answered=len(result.latencies),
        at_once=at_once,
        answers=f"{answers}, {phrases.whole(at_once)} of them at the same tick"
        f"{_perhaps(unknown, len(result.latencies))}",
        median=phrases.duration(median(result.latencies), bounds),
        longest=f"{phrases.duration(longest, bounds)}{after}",
        longest_s=longest,
        is_bounded=is_bounded(requirement),
        bound=_bound(requirement),
        waits=_waits(result),
        median_s=round(median(result.latencies), 9),
    )


def _unanswered(result: Result, requirement: FormalizedRequirement | None) -> str:
    """`> 200 ms (4 unanswered); overdue up to 500 ms after the trigger`.

    The longest latency counts answers only, which are in time: beside a violation it would read as
    if the bound were kept.
    """
    count = len(result.triggers) - len(result.latencies) - len(result.open)
    if requirement is None or count <= 0 or not syntax.deadline(requirement.sentence.timing):
        return ""
    allowed = seconds_allowed(requirement)
    bound = (
        span(requirement.ticks or 0, requirement.clock)
        if allowed is None
        else phrases.exact_duration(allowed)
    )
    overdue = [
        round(end - violation.trigger.seconds, 9)
        for violation in result.violations
        if violation.trigger and (end := end_s(violation.last, result.clock)) is not None
    ]
    late = f"; overdue up to {phrases.duration(max(overdue))} after the trigger" if overdue else ""
    return f"> {bound} ({phrases.whole(count)} unanswered){late}"


def is_bounded(requirement: FormalizedRequirement | None) -> bool:
    """Whether the sentence limits the time of the response; True if unknown."""
    return requirement is None or not syntax.is_eventual(requirement.sentence.timing)


def _bound(requirement: FormalizedRequirement | None) -> str:
    """The time that the sentence allows for the response, in words."""
    if requirement is None:
        return ""
    if syntax.deadline(requirement.sentence.timing):
        return f"The sentence allows {span(requirement.ticks or 0, requirement.clock)}."
    if not syntax.is_eventual(requirement.sentence.timing):
        return ""
    word = syntax.timing_key(requirement.sentence)
    how = "has no timing, which means `eventually`" if word == "null" else f"says `{word}`"
    return f"No bound was required: the sentence {how}, so a response at any time satisfies it."


def _waits(result: Result) -> tuple[str, ...]:
    """The longest waits; triggers with one answer are one wait."""
    waiting = [(m.seconds, round(m.seconds + late, 6)) for m, late in answered(result) if late > 0]
    ends = groupby(sorted(waiting, key=lambda wait: wait[::-1]), key=lambda wait: wait[1])
    waits = [(end, [start for start, _ in group]) for end, group in ends]
    waits.sort(key=lambda wait: (wait[1][0] - wait[0], wait[0]))
    return tuple(_wait(starts, end) for end, starts in waits[:_WAITS])


def _wait(starts: Sequence[float], end: float) -> str:
    first = "the first " if len(starts) > 1 else ""
    return (
        f"{phrases.seconds(starts[0])} to {phrases.seconds(end)}: "
        f"{phrases.times(len(starts), 'trigger')}, "
        f"{first}waited {phrases.duration(round(end - starts[0], 9))}"
    )


# Stretches -------------------------------------------------------------------------------------


def _violation(
    violation: Violation,
    result: Result,
    ages: Mapping[str, float],
    requirement: FormalizedRequirement | None,
) -> ViolationView:
    first, last, trigger = violation.first, violation.last, violation.trigger
    end = end_s(last, result.clock)
    ticks = f"{first.tick}" if first.tick == last.tick else f"{first.tick} to {last.tick}"
    return ViolationView(
        start=phrases.seconds(first.seconds),
        end=phrases.seconds(last.seconds if end is None else end),
        lasts="" if end is None else interval_length(first, end),
        ticks=ticks,
        trigger=_at(trigger) if trigger else "none",
        deadline=_at(violation.deadline) if violation.deadline else "none",
        missing=violation.missing,
        values=tuple(
            (name, reading(name, violation, result, ages)) for name in sorted(violation.values)
        ),
        causes=tuple(dict.fromkeys(cause.text for cause in causes(violation, result, requirement))),
    )


def _at(moment: Moment) -> str:
    return f"{phrases.seconds(moment.seconds)} (tick {moment.tick})"


def _threshold(threshold: ThresholdRecord) -> ThresholdView:
    kept, unit, bound = threshold.comparison, threshold.unit, threshold.bound
    least, greatest = (
        phrases.value(number, unit, [bound]) for number in (threshold.least, threshold.greatest)
    )
    margin = {None: "never known", "crossed": "crossed"}.get(kept) or (
        "always out of range"
        if threshold.margin is None
        else margin_text(threshold.margin, unit, bound)
    )
    return ThresholdView(
        proposition=threshold.proposition,
        comparison=f"{threshold.signal} {threshold.operator} {exact(bound, unit)}",
        values="unknown" if threshold.least is None else f"{least} to {greatest}",
        margin=margin,
        nearest="" if threshold.nearest is None else phrases.seconds(threshold.nearest.seconds),
    )


def _open(result: Result) -> Listing:
    stretches = _stretches(result.open)
    lines = (_since(stretch, result.uncertain) for stretch in stretches[:LISTED])
    return Listing(tuple(lines), len(result.open))


def _since(stretch: Sequence[Moment], uncertain: Collection[int]) -> str:
    first, last = stretch[0], stretch[-1]
    unknown = _perhaps(sum(moment.tick in uncertain for moment in stretch), len(stretch))
    if len(stretch) == 1:
        return f"triggered at {phrases.seconds(first.seconds)} (tick {first.tick}){unknown}"
    return (
        f"triggered from {phrases.seconds(first.seconds)} to {phrases.seconds(last.seconds)} "
        f"(ticks {first.tick} to {last.tick}): {phrases.times(len(stretch), 'demand')}{unknown}"
    )


def _perhaps(count: int, of: int) -> str:
    """A phrase with the number of uncertain items, or ""."""
    if not count:
        return ""
    some = "" if of == 1 else "all of them " if count == of else f"{count} of them "
    return f", {some}uncertain because propositions are unknown"


def _unknown(result: Result) -> Listing:
    runs = result.unknown
    total = sum(max(0, last - first + 1) for first, last in runs)
    lines = (
        f"tick {first}" if first == last else f"ticks {first} to {last}"
        for first, last in runs[:LISTED]
    )
    return Listing(tuple(lines), total)


def _unknown_inputs(result: Result) -> Listing:
    inputs = result.unknown_inputs or ()
    lines = (one.in_words(result.clock) for one in inputs[:LISTED])
    return Listing(tuple(lines), len(inputs))


# Reasons ---------------------------------------------------------------------------------------


def reasons(
    assessment: Assessment, runs: Mapping[RunKey, AuditedFile], *, audited: bool
) -> tuple[str, ...]:
    """Why a requirement is not shown, worst reason first; empty if it is shown or retired."""
    if assessment.is_shown or assessment.unwaived == RETIRED:
        return ()
    lines = [(severity(UNFORMALIZED), text) for text in _unformalized(assessment)]
    left = len(lines) - _NAMED
    if assessment.probability is not None:
        probability = assessment.probability
        lines.append((probability.mark.severity, _probability_reason(probability)))
    else:
        unshown = [audit for audit in assessment.audits if not audit.mark.shows]
        damaged = [audit for audit in unshown if _is_lost(audit)]
        audits = unshown if len(damaged) == 1 else [a for a in unshown if not _is_lost(a)]
        left += len(audits)
        worst = sorted(audits, key=lambda audit: audit.mark.severity)[:_NAMED]
        lines += [(audit.mark.severity, _run_reason(audit, runs)) for audit in worst]
        if len(damaged) > 1:
            lines.append((damaged[0].mark.severity, _damaged_reason(damaged, runs)))
        if not assessment.audits and assessment.requirement is not None:
            why = "the audit did not cover it" if audited else "no run has been audited"
            lines.append((severity(NOT_EXERCISED), why))
    texts = [text for _, text in sorted(lines, key=lambda line: line[0])]
    few = (*texts[:_NAMED], f"and {phrases.times(left, 'more run')}") if left > 0 else tuple(texts)
    held = sum(audit.mark.shows for audit in assessment.audits)
    if 0 < held < len(assessment.audits) and assessment.probability is None:
        few = (*few, f"it holds in {held} of {phrases.times(len(assessment.audits), 'run')}")
    return (*few, *since_review(assessment.review_status))


def _unformalized(assessment: Assessment) -> Iterator[str]:
    if assessment.diagnostic is not None and assessment.requirement is None:
        yield f"{assessment.diagnostic.code.number}: {assessment.diagnostic.message}"


def _probability_reason(probability: ProbabilityAudit) -> str:
    estimation, why = probability.estimation, _because(probability.suspicions)
    return f"over all runs: {estimation.answer}, {estimation.reason}{why}"


def _run_reason(audit: SingleAudit, runs: Mapping[RunKey, AuditedFile]) -> str:
    result = audit.result
    label = runs[run_key(result)].name
    return f"{label}: {audit.verdict}, {result.reason}{_because(audit.suspicions)}"


def _is_lost(audit: SingleAudit) -> bool:
    """Whether the damage of the log leaves the verdict open."""
    return audit.verdict == kernel.NO_DATA and not audit.result.intact


def _damaged_reason(audits: Sequence[SingleAudit], runs: Mapping[RunKey, AuditedFile]) -> str:
    names = phrases.some([runs[run_key(audit.result)].name for audit in audits], 4)
    return f"no data from {len(audits)} damaged logs: {names}"


def _because(suspicions: Sequence[str]) -> str:
    return f"; {SUSPECT}, because {phrases.joined(suspicions)}" if suspicions else ""
