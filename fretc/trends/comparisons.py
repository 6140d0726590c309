"""Significance tests of latencies and margins of the newest version against those before.

Each run counts with one number of a kind, because events within a run are not independent: the
longest and the median latency of its answers, and its least margin to each threshold. Larger
latencies and smaller margins are worse. Runs of one scenario are ranked with each other.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from statistics import median

from fretc.audit.evidence.schema import ThresholdRecord
from fretc.report.model.phrases import some, times, value
from fretc.trends.histories import ComparableRuns, Histories, HistoryRun, RunOutcome
from fretc.trends.rank_test import RankTest, decidable, fewer, holm, larger
from fretish.classes.frozen import dataclass

LEVEL = 0.05
"""The probability of even one false regression among all that are reported."""


class MeasureKind(StrEnum):
    """The kind of number of a run."""

    LONGEST = "longest latency"
    MEDIAN = "median latency"
    MARGIN = "margin"


class ComparisonFinding(StrEnum):
    """The finding of a comparison; the worst first."""

    REGRESSED = "regressed"
    TOO_FEW = "too few runs to tell"
    CHANCE = "no worse than chance"


@dataclass(frozen=True, slots=True)
class ComparedMeasure:
    """A compared number: a latency of a requirement, or the margin of some to one threshold."""

    requirements: tuple[str, ...]
    kind: MeasureKind
    unit: str
    threshold: str = ""
    """`clearance < 0.05 m (too_close)`; empty for a latency."""

    @property
    def is_better_larger(self) -> bool:
        """Whether a larger number is better."""
        return self.kind is MeasureKind.MARGIN

    @property
    def ids(self) -> str:
        """The ids of its requirements, as text."""
        return some(self.requirements, 3)

    def __str__(self) -> str:
        """The measure as text."""
        return f"{self.kind} to {self.threshold}" if self.threshold else str(self.kind)


@dataclass(frozen=True, slots=True)
class Value:
    """The number of one run."""

    run: int
    scenario: ComparableRuns
    round: int
    number: float


@dataclass(frozen=True, slots=True)
class VersionComparison:
    """A measure of the newest version compared with the version before it."""

    measure: ComparedMeasure
    finding: ComparisonFinding
    before: float | None
    """Medians of the compared runs; None: there are none."""
    after: float | None
    runs_before: int
    runs_after: int
    p: float | None
    """The p-value, adjusted for all comparisons; None: not tested."""
    values: tuple[Value, ...]
    """The values of all runs whose requirement is unchanged, for the chart."""

    @property
    def worse(self) -> str:
        """The medians, the numbers of runs, and the p-value, in words."""
        ends = (amount(number or 0.0, self.measure.unit) for number in (self.before, self.after))
        p = 1.0 if self.p is None else self.p
        chance = "p < 0.001" if p < 0.001 else f"p = {p:.2g}"
        runs = f"{self.runs_before} and {times(self.runs_after, 'run')}"
        return f"{' to '.join(ends)} ({runs}), {chance}"


@dataclass(frozen=True, slots=True)
class ComparedRuns:
    """The two compared sets of runs."""

    after: str
    before: str
    is_after: Callable[[HistoryRun], bool]
    is_before: Callable[[HistoryRun], bool]


def compared_runs(histories: Histories) -> ComparedRuns:
    """The newest version and the one before it; else the newest round and all before it.

    A version is as new as its newest run.
    """
    place: dict[str, tuple[int, int]] = {}
    for run in histories.runs:
        if run.version:
            age = run.round, run.time if run.time is not None else -1
            place[run.version] = max(age, place.get(run.version, (-1, -1)))
    versions = sorted(place, key=place.__getitem__)
    if len(versions) > 1 and place[versions[-1]][0] == histories.newest:
        before, after = versions[-2:]
        return ComparedRuns(
            f"version {after}",
            f"version {before}",
            lambda run: run.version == after,
            lambda run: run.version == before,
        )
    newest = histories.newest
    return ComparedRuns(
        "the newest round",
        "the rounds before it",
        lambda run: run.round == newest,
        lambda run: run.round < newest,
    )


def comparisons(
    histories: Histories, compared: ComparedRuns, level: float = LEVEL
) -> tuple[VersionComparison, ...]:
    """All comparisons, the regressions first.

    Only comparisons that could be significant among all others are tested (Tarone): this depends on
    the number of runs and on equal numbers, never on which of them are the newest.

    Args:
        histories: the histories of all evidence.
        compared: the two compared sets of runs.
        level: the probability of even one false regression.
    """
    measured = _measured(histories)
    tested = [_tested(histories.runs, compared, measure, values) for measure, values in measured]
    family = decidable([tail.least for tail, _ in tested], level)
    adjusted = dict(zip(family, holm([tested[i][0].p for i in family]), strict=True))
    all_comparisons = [
        _comparison(measure, values, tested[i][1], adjusted.get(i), level)
        for i, (measure, values) in enumerate(measured)
    ]
    order = list(ComparisonFinding)
    return tuple(sorted(all_comparisons, key=lambda one: (order.index(one.finding), one.p or 1.0)))


def _measured(histories: Histories) -> list[tuple[ComparedMeasure, tuple[Value, ...]]]:
    """Each measure with its values; a measure that several requirements share is one."""
    shared: dict[tuple[object, ...], tuple[ComparedMeasure, tuple[Value, ...]]] = {}
    for requirement in histories.requirements:
        for measure, values in _measures(histories, requirement):
            of_latency = () if measure.threshold else measure.requirements
            key = measure.threshold, measure.unit, of_latency, values
            known = shared.get(key)
            if known is None:
                shared[key] = measure, values
            elif measure.threshold:
                ids = (*known[0].requirements, requirement)
                shared[key] = replace(known[0], requirements=ids), values
    return list(shared.values())


_Strata = Sequence[tuple[Sequence[float], Sequence[float]]]


def _tested(
    runs: Sequence[HistoryRun],
    compared: ComparedRuns,
    measure: ComparedMeasure,
    values: Sequence[Value],
) -> tuple[RankTest, _Strata]:
    """The test, and its numbers: each log once, the newest ones first."""
    strata: dict[ComparableRuns, tuple[list[float], list[float]]] = defaultdict(lambda: ([], []))
    passed: set[str] = set()
    for run_value in values:  # from the oldest round on, so that copies in later rounds are skipped
        run = runs[run_value.run]
        is_after = compared.is_after(run)
        if run.content in passed or not (is_after or compared.is_before(run)):
            continue
        passed.add(run.content)
        strata[run_value.scenario][is_after].append(run_value.number)
    both = fewer([(before[::-1], after[::-1]) for before, after in strata.values()])
    sign = -1 if measure.is_better_larger else 1
    return larger([([sign * x for x in b], [sign * x for x in a]) for b, a in both]), both


def _comparison(
    measure: ComparedMeasure,
    values: tuple[Value, ...],
    strata: _Strata,
    p: float | None,
    level: float,
) -> VersionComparison:
    before = [number for side, _ in strata for number in side]
    after = [number for _, side in strata for number in side]
    constant = len({*before, *after}) == 1
    if p is None:
        finding = ComparisonFinding.CHANCE if constant else ComparisonFinding.TOO_FEW
    else:
        finding = ComparisonFinding.REGRESSED if p <= level else ComparisonFinding.CHANCE
    return VersionComparison(
        measure,
        finding,
        median(before) if before else None,
        median(after) if after else None,
        len(before),
        len(after),
        p,
        values,
    )


# Measures ---------------------------------------------------------------------------------------


def _measures(
    histories: Histories, requirement: str
) -> Iterator[tuple[ComparedMeasure, tuple[Value, ...]]]:
    """The measures of a requirement, with the values of all comparable runs."""
    judged = [
        one
        for (id, _), some in histories.judged.items()
        if id == requirement
        for one in some
        if one.run >= 0
    ]
    if not judged:
        return
    judged.sort(key=lambda one: (one.round, histories.runs[one.run].time or -1, one.run))
    verdict_inputs = judged[-1].verdict_inputs
    same = [outcome for outcome in judged if outcome.verdict_inputs == verdict_inputs]
    for kind in (MeasureKind.LONGEST, MeasureKind.MEDIAN):
        numbers = [one.longest if kind is MeasureKind.LONGEST else one.median for one in same]
        values = [_value(histories.runs, *pair) for pair in zip(same, numbers, strict=True)]
        known_values = tuple(value for value in values if value is not None)
        if known_values:
            yield ComparedMeasure((requirement,), kind, "s"), known_values
    yield from _margins(histories, requirement, same)


def _value(runs: Sequence[HistoryRun], one: RunOutcome, number: float | None) -> Value | None:
    if number is None:
        return None
    return Value(one.run, runs[one.run].scenario, one.round, float(number))


def _margins(
    histories: Histories, requirement: str, same: Sequence[RunOutcome]
) -> Iterator[tuple[ComparedMeasure, tuple[Value, ...]]]:
    """The least margin of each run to each threshold; 0 for a crossed one."""
    known = {one.run: one for one in same}
    found: dict[ComparedMeasure, dict[int, float]] = defaultdict(dict)
    for source, places in zip(histories.sources, histories.places, strict=True):
        for index, thresholds in source.thresholds([requirement]):
            run = places[index]
            for each in thresholds if run in known else ():
                margin = 0.0 if each.comparison == "crossed" else each.margin
                if margin is not None:
                    found[_threshold(requirement, each)][run] = margin
    for measure, margins in found.items():
        ordered = [(one, margins[run]) for run, one in known.items() if run in margins]
        values = (_value(histories.runs, one, number) for one, number in ordered)
        yield measure, tuple(value for value in values if value is not None)


def _threshold(requirement: str, each: ThresholdRecord) -> ComparedMeasure:
    bound = f"{each.bound:.9g}{f' {each.unit}' if each.unit else ''}"
    text = f"{each.signal} {each.operator} {bound} ({each.proposition})"
    return ComparedMeasure((requirement,), MeasureKind.MARGIN, each.unit, text)


def amount(number: float, unit: str) -> str:
    """A number of three digits with its unit."""
    return value(float(f"{number:.3g}"), unit)


def by_finding(comparisons: Sequence[VersionComparison]) -> Mapping[ComparisonFinding, int]:
    """The number of comparisons with each finding."""
    return {kind: sum(one.finding is kind for one in comparisons) for kind in ComparisonFinding}
