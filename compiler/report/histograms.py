"""What all runs together show of a requirement: how often it was asked, how late, how near."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from math import floor
from statistics import median

from compiler.evidence import Result, Threshold
from compiler.report import phrases
from compiler.report.claims import Claim
from compiler.report.pictures import Bin, Histogram
from compiler.rule import Rule
from fretish import syntax

_BINS = 20
"""At most some so many bars."""
_MARGINS = 3
"""Thresholds of a requirement that get a histogram of their own."""
_NAMED = 3


def step(least: float) -> float:
    """1, 2 or 5 times a power of ten, not below `least`."""
    if least <= 0:
        return 1.0
    power = 10.0 ** len(str(int(least))) if least >= 1 else 1.0
    while power / 10 >= least and power > 1e-9:
        power /= 10
    return next((power / 10 * n for n in (1, 2, 5) if power / 10 * n >= least), power)


def exercise(claim: Claim) -> str:
    """How often all runs that count have asked for it, in one line."""
    counted = _counted(claim)
    if not claim.judged:
        return ""
    if not counted:
        return f"none of {phrases.times(len(claim.judged), 'run')} counts: all are suspect"
    triggers = sum(len(result.triggers) for result in counted)
    answers = sum(len(result.latencies) for result in counted)
    unanswered = sum(len(result.open) for result in counted)
    asked = sum(bool(result.triggers) for result in counted)
    suspect = len(claim.judged) - len(counted)
    parts = [
        phrases.times(len(counted), "run"),
        phrases.times(triggers, "trigger"),
        f"triggered in {phrases.whole(asked)} of them" if len(counted) > 1 else "",
        f"{phrases.whole(answers)} answered" if answers else "",
        f"{phrases.whole(unanswered)} open at the end" if unanswered else "",
        phrases.times(sum(len(r.violations) for r in counted), "violation"),
        f"{phrases.times(suspect, 'suspect run')} left out" if suspect else "",
    ]
    return ", ".join(filter(None, parts))


def histograms(claim: Claim) -> tuple[Histogram, ...]:
    """Of latency, then of the least margin of each run; none of fewer than two values."""
    counted = _counted(claim)
    late = [latency for result in counted for latency in result.latencies]
    found = [_latency(late, len(counted), claim.rule)] if len(late) > 1 else []
    margins = list(_margins(counted)) if len(counted) > 1 else []
    return (*found, *margins[:_MARGINS])


def _counted(claim: Claim) -> list[Result]:
    return [judged.result for judged in claim.judged if not judged.is_stale]


# Latency ---------------------------------------------------------------------------------------


def _latency(late: Sequence[float], runs: int, rule: Rule | None) -> Histogram:
    bound = _seconds_allowed(rule)
    bins = _bins(late, [0.0, *([bound] if bound is not None else [])])
    label = f"bound {phrases.seconds(bound)}" if bound is not None else ""
    beyond = sum(value > bound + 1e-9 for value in late) if bound is not None else 0
    limit = (
        f"{label}, {phrases.whole(beyond)} later" if bound is not None else "no bound in seconds"
    )
    text = (
        f"{phrases.times(len(late), 'answer')} in {phrases.times(runs, 'run')}: "
        f"median {phrases.seconds(median(late))}, longest {phrases.seconds(max(late))}; "
        f"{limit}. {_in_words(bins, 's')}"
    )
    return Histogram("Latency of the answers", "s", bins, bound, label, text)


def _seconds_allowed(rule: Rule | None) -> float | None:
    """What `within` allows, where a tick is a time."""
    if rule is None or not isinstance(rule.sentence.timing, syntax.Within):
        return None
    if rule.clock is None or rule.clock.period is None or rule.ticks is None:
        return None
    return rule.ticks * rule.clock.period / 1e9


# Margin ----------------------------------------------------------------------------------------


def _margins(results: Sequence[Result]) -> Iterator[Histogram]:
    """Those that are known of two runs at least, in the order of the propositions."""
    grouped: dict[tuple[str, str, str, float, str], list[Threshold]] = defaultdict(list)
    for result in results:
        for each in result.thresholds:
            name = (each.proposition, each.signal, each.operator, each.bound, each.unit)
            grouped[name].append(each)
    for (proposition, signal, operator, bound, unit), found in grouped.items():
        known = [each.margin for each in found if each.margin is not None]
        if len(known) < 2:
            continue
        crossed = sum(each.comparison == "crossed" for each in found)
        bins = _bins(known, [0.0])
        comparison = f"{signal} {operator} {phrases.value(bound, unit)}"
        text = (
            f"{phrases.times(len(known), 'run')} with a margin: least "
            f"{phrases.value(min(known), unit)}, median {phrases.value(median(known), unit)}; "
            f"{_crossed(crossed)}. {_in_words(bins, unit)}"
        )
        title = f"Least margin of each run to {comparison} ({proposition})"
        yield Histogram(title, unit, bins, 0.0, "threshold", text, crossed)


def _crossed(runs: int) -> str:
    return (
        f"in {phrases.times(runs, 'run')} the threshold was crossed"
        if runs
        else "crossed in no run"
    )


# Bins ------------------------------------------------------------------------------------------


def _bins(values: Sequence[float], shown: Sequence[float]) -> tuple[Bin, ...]:
    """Bars of a round width, from the least to the greatest of the values and what is shown."""
    low, high = min([*values, *shown]), max([*values, *shown])
    width = step((high - low) / _BINS) if high > low else 1.0
    first = _place(low, width)
    last = max(first, _place(high, width))
    counts = [0] * (last - first + 1)
    for value in values:
        counts[_place(value, width) - first] += 1
    return tuple(
        Bin(round((first + i) * width, 9), round((first + i + 1) * width, 9), count)
        for i, count in enumerate(counts)
    )


def _place(value: float, width: float) -> int:
    """The bar of a value; one that is at a border, but for rounding, counts above it."""
    return floor(value / width + 1e-9)


def _in_words(bins: Sequence[Bin], unit: str) -> str:
    """The fullest bars, in their order."""
    full = [each for each in bins if each.count]
    told = sorted(sorted(full, key=lambda each: -each.count)[:_NAMED], key=lambda each: each.low)
    parts = [
        f"{phrases.whole(each.count)} from {phrases.decimal(each.low)} to "
        f"below {phrases.value(each.high, unit)}"
        for each in told
    ]
    rest = sum(each.count for each in full) - sum(each.count for each in told)
    return f"{phrases.joined([*parts, *([f'{phrases.whole(rest)} elsewhere'] if rest else [])])}."
