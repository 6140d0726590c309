"""Histograms over all runs of a requirement: latencies and margins."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from math import ceil, floor
from statistics import median

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.result_summaries import ResultSummary
from fretc.audit.evidence.schema import ThresholdRecord
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.pictures import Bin, Histogram
from fretc.report.pictures.scales import step
from fretish import syntax

_BINS = 20
"""Approximate number of bars."""
_MARGINS = 3
"""Maximum number of thresholds of a requirement with a histogram."""
_NAMED = 3
"""Maximum number of bars that the text names."""


def exercise(assessment: Assessment) -> str:
    """Runs, triggers, answers and violations of all current results, in one line."""
    results = _current_results(assessment)
    if not assessment.audits:
        return ""
    if not results:
        return (
            f"none of {phrases.times(len(assessment.audits), 'run')} counts, because all "
            "are suspect"
        )
    triggers = sum(result.triggers for result in results)
    answers = sum(result.answers for result in results)
    waiting = sum(result.open for result in results)
    unanswered = sum(map(_unanswered, results)) if is_answered(assessment.requirement) else 0
    asked = sum(bool(result.triggers) for result in results)
    suspect = len(assessment.audits) - len(results)
    parts = [
        phrases.times(len(results), "run"),
        phrases.times(triggers, "trigger")
        + (f" in {phrases.whole(asked)} of them" if len(results) > 1 else ""),
        f"{phrases.whole(answers)} answered" if answers else "",
        f"{phrases.whole(unanswered)} without an answer" if unanswered else "",
        f"{phrases.whole(waiting)} open at the end" if waiting else "",
        phrases.times(sum(result.violations for result in results), "violation"),
        f"{phrases.times(suspect, 'suspect run')} left out" if suspect else "",
    ]
    return ", ".join(filter(None, parts))


def histograms(
    assessment: Assessment,
    latencies: Mapping[int, Sequence[float]],
    thresholds: Mapping[int, Sequence[ThresholdRecord]],
) -> tuple[Histogram, ...]:
    """A histogram of latencies, then one for each threshold; each needs at least two values.

    Args:
        assessment: the assessment of the requirement.
        latencies: index of a result → its latencies.
        thresholds: index of a result → its thresholds, in declared units.
    """
    results = _current_results(assessment)
    places = [audit.place for audit in assessment.audits if not audit.is_stale]
    late = [latency for place in places for latency in latencies[place]]
    latency_histogram = [_latency(late, results, assessment.requirement)] if len(late) > 1 else []
    margins = _margins(thresholds[place] for place in places) if len(results) > 1 else iter(())
    return (*latency_histogram, *islice(margins, _MARGINS))


def _current_results(assessment: Assessment) -> list[ResultSummary]:
    return [audit.result for audit in assessment.audits if not audit.is_stale]


# Latency ---------------------------------------------------------------------------------------


def is_answered(requirement: FormalizedRequirement | None) -> bool:
    """Whether each trigger requires a response."""
    return requirement is not None and requirement.watch.answer is not None


def _unanswered(result: ResultSummary) -> int:
    """Number of triggers whose deadline or scope ended without an answer."""
    return max(0, result.triggers - result.answers - result.open)


def _latency(
    late: Sequence[float], runs: Sequence[ResultSummary], requirement: FormalizedRequirement | None
) -> Histogram:
    bound = seconds_allowed(requirement)
    bins = _bins(late, [0.0, *([bound] if bound is not None else [])], _below)
    label = f"bound {phrases.exact_duration(bound)}" if bound is not None else ""
    unanswered = sum(map(_unanswered, runs)) if is_answered(requirement) else 0
    waiting = sum(result.open for result in runs)
    beyond = sum(value > bound + 1e-9 for value in late) if bound is not None else 0
    limit = (
        f"{label}, {phrases.whole(beyond)} later" if bound is not None else "no bound in seconds"
    )
    text = (
        f"{phrases.times(len(late), 'answer')} in {phrases.times(len(runs), 'run')}: "
        f"{_late(late, bound)}; "
        f"{limit}. {_in_words(bins, 's', _UP_TO)}{_without(unanswered, waiting)}"
    )
    return Histogram(
        "Latency of the answers",
        "s",
        bins,
        bound,
        label,
        text,
        unanswered=unanswered,
        open=waiting,
    )


def _without(unanswered: int, waiting: int) -> str:
    """A sentence about triggers without an answer."""
    parts = [
        f"{phrases.times(unanswered, 'trigger')} whose deadline or scope ended"
        if unanswered
        else "",
        f"{phrases.times(waiting, 'trigger')} open at the end of a run" if waiting else "",
    ]
    triggers = phrases.joined(list(filter(None, parts)))
    return f" Without an answer: {triggers}." if triggers else ""


def seconds_allowed(requirement: FormalizedRequirement | None) -> float | None:
    """The allowed latency in seconds; None without a bound in seconds."""
    if requirement is None or syntax.deadline(requirement.sentence.timing) is None:
        return None
    if requirement.clock is None or requirement.clock.period is None or requirement.ticks is None:
        return None
    return requirement.ticks * requirement.clock.period / 1e9


# Margin ----------------------------------------------------------------------------------------


def _late(late: Sequence[float], bound: float | None) -> str:
    """Median and longest latency in words, or the latency of the only answer."""
    bounds = [] if bound is None else [bound]
    middle, longest = (phrases.duration(latency, bounds) for latency in (median(late), max(late)))
    return longest if len(late) == 1 else f"median {middle}, longest {longest}"


def _margins(runs: Iterable[Sequence[ThresholdRecord]]) -> Iterator[Histogram]:
    """A histogram for each threshold with a margin in at least two runs, ordered by proposition."""
    grouped: dict[tuple[str, str, str, float, str], list[ThresholdRecord]] = defaultdict(list)
    for thresholds in runs:
        for threshold in thresholds:
            name = (
                threshold.proposition,
                threshold.signal,
                threshold.operator,
                threshold.bound,
                threshold.unit,
            )
            grouped[name].append(threshold)
    for (proposition, signal, operator, bound, unit), same in grouped.items():
        margins = [each.margin for each in same if each.margin is not None]
        if len(margins) < 2 or _is_truth(unit, bound, same):
            continue
        crossed = sum(each.comparison == "crossed" for each in same)
        bins = _bins(margins, [0.0], _above)
        comparison = f"{signal} {operator} {phrases.value(bound, unit)}"
        text = (
            f"{phrases.times(len(margins), 'run')} with a margin: least "
            f"{phrases.value(min(margins), unit)}, median {phrases.value(median(margins), unit)}; "
            f"{_crossed(crossed)}. {_in_words(bins, unit, _FROM)}"
        )
        title = f"Least margin of each run to {comparison} ({proposition})"
        yield Histogram(title, unit, bins, 0.0, "threshold", text, crossed)


def _is_truth(unit: str, bound: float, same: Sequence[ThresholdRecord]) -> bool:
    """Whether the signal is only 0 or 1 and compared with 0.5; such margins say nothing."""
    ends = {end for each in same for end in (each.least, each.greatest) if end is not None}
    return not unit and bound == 0.5 and ends <= {0.0, 1.0}


def _crossed(runs: int) -> str:
    return (
        f"in {phrases.times(runs, 'run')} the threshold was crossed"
        if runs
        else "crossed in no run"
    )


# Bins ------------------------------------------------------------------------------------------


def _bins(
    values: Sequence[float], marks: Sequence[float], place: Callable[[float, float], int]
) -> tuple[Bin, ...]:
    """Bars of a round width that cover all values and marks.

    Args:
        values: the numbers to count.
        marks: numbers on the axis that the bars must reach.
        place: the bar of a value, counted from 0, for a width.
    """
    low, high = min([*values, *marks]), max([*values, *marks])
    width = step((high - low) / _BINS) if high > low else 1.0
    first = place(low, width)
    last = max(first, place(high, width))
    counts = [0] * (last - first + 1)
    for value in values:
        counts[place(value, width) - first] += 1
    return tuple(
        Bin(round((first + i) * width, 9), round((first + i + 1) * width, 9), count)
        for i, count in enumerate(counts)
    )


def _above(value: float, width: float) -> int:
    """Bar of a value, with borders belonging to the bar above, up to rounding."""
    return floor(value / width + 1e-9)


def _below(value: float, width: float) -> int:
    """Bar of a value, with borders belonging to the bar below, up to rounding."""
    return max(0, ceil(value / width - 1e-9) - 1)


_FROM, _UP_TO = "{count} from {low} to below {high}", "{count} {above} {low} up to {high}"


def _in_words(bins: Sequence[Bin], unit: str, form: str) -> str:
    """The fullest bars, in their order."""
    full = [column for column in bins if column.count]
    fullest = sorted(sorted(full, key=lambda each: -each.count)[:_NAMED], key=lambda each: each.low)
    parts = [
        form.format(
            count=phrases.whole(column.count),
            low=phrases.decimal(column.low),
            above="above" if column.low > 0 else "from",
            high=phrases.value(column.high, unit),
        )
        for column in fullest
    ]
    rest = sum(column.count for column in full) - sum(column.count for column in fullest)
    return f"{phrases.joined([*parts, *([f'{phrases.whole(rest)} elsewhere'] if rest else [])])}."
