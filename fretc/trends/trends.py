"""The changes of all requirements between rounds: one value for text, JSON and page."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.trends.changes import (
    RED,
    RoundOutcome,
    VerdictChange,
    change,
    is_flaky,
    last_known,
    round_outcome,
)
from fretc.trends.comparisons import (
    LEVEL,
    ComparedRuns,
    ComparisonFinding,
    VersionComparison,
    compared_runs,
    comparisons,
)
from fretc.trends.histories import (
    DAY,
    EVIDENCE,
    ComparableRuns,
    Histories,
    Round,
    RunOutcome,
    histories,
    verdicts_of_rounds,
)
from fretc.trends.left_out import is_left_out
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.natural_order import natural


@dataclass(frozen=True, slots=True)
class Item:
    """A requirement in a scenario, with its change."""

    requirement: str
    scenario: ComparableRuns
    change: VerdictChange
    flaky: bool
    changed: bool
    """Whether the requirement or its bindings differ from those of an earlier round."""
    rounds: tuple[tuple[str, ...], ...]
    """The verdicts of each round, the newest last."""

    @property
    def round_outcomes(self) -> tuple[RoundOutcome | None, ...]:
        """The combined verdict of each round; None: not judged."""
        return tuple(round_outcome(verdicts) if verdicts else None for verdicts in self.rounds)

    @property
    def was_violated(self) -> bool:
        """Whether it was violated when it was last known before the newest round."""
        last = last_known(self.rounds)
        return last is not None and self.round_outcomes[last] is RoundOutcome.VIOLATED

    @property
    def last(self) -> RoundOutcome:
        """The verdicts of the last round that judged it."""
        if self.change is VerdictChange.NOT_SELECTED and self.was_violated:
            return RoundOutcome.VIOLATED
        return next(filter(None, reversed(self.round_outcomes)))


@dataclass(frozen=True, slots=True)
class Trends:
    """The trends of all evidence."""

    by: str
    rounds: tuple[Round, ...]
    sentences: Mapping[str, str]
    """Id of a requirement → its sentence."""
    items: tuple[Item, ...]
    """Items, the worst first."""
    compared: ComparedRuns
    comparisons: tuple[VersionComparison, ...]
    level: float
    is_after: tuple[bool, ...]
    """For each run, whether it belongs to the newer side of the comparison."""
    order: str
    """The order of rounds, in words."""

    @property
    def runs(self) -> int:
        """The number of runs."""
        return len(self.is_after)

    def of(self, *kinds: VerdictChange) -> tuple[Item, ...]:
        """The items of some kinds."""
        return tuple(item for item in self.items if item.change in kinds)

    def with_finding(self, kind: ComparisonFinding) -> tuple[VersionComparison, ...]:
        """The comparisons with a finding."""
        return tuple(comparison for comparison in self.comparisons if comparison.finding is kind)

    @property
    def is_worse(self) -> bool:
        """Whether a requirement is newly violated, or a number has regressed."""
        return bool(self.of(*RED) or self.with_finding(ComparisonFinding.REGRESSED))

    @property
    def has_pairs(self) -> bool:
        """Whether any requirement was judged in two rounds."""
        return any(sum(map(bool, item.rounds)) > 1 for item in self.items)

    @property
    def is_comparable(self) -> bool:
        """Whether every requirement known before is known now, and any can be compared.

        A requirement that was not selected, as the user asked for, is missing only if it was
        violated.
        """
        return self.has_pairs and not self.lost

    @property
    def lost(self) -> tuple[Item, ...]:
        """Items known before and not now, except those not selected and not violated."""
        left_out = (item for item in self.of(VerdictChange.NOT_SELECTED) if item.was_violated)
        return (*self.of(VerdictChange.LOST, VerdictChange.GONE), *left_out)


@dataclass(frozen=True, slots=True)
class Group:
    """Items of one scenario, or of one requirement, that have all appeared, or all disappeared."""

    name: str
    """`scenario safety-late`, `requirement R7`, or `R7 in safety-late`."""
    items: tuple[Item, ...]

    @property
    def text(self) -> str:
        """The name with the last verdicts."""
        last = [item.last for item in self.items]
        counts = [f"{last.count(outcome)} {outcome}" for outcome in RoundOutcome if outcome in last]
        return f"{self.name}: {', '.join(counts)}"


def grouped(trends: Trends, *kinds: VerdictChange) -> tuple[Group, ...]:
    """Items of some kinds: whole scenarios, whole requirements, then the others one by one."""
    others = [item for item in trends.items if item.change not in kinds]
    scenarios, requirements = {i.scenario for i in others}, {i.requirement for i in others}
    groups: dict[str, list[Item]] = defaultdict(list)
    for item in trends.of(*kinds):
        if item.scenario not in scenarios:
            groups[f"scenario {item.scenario}"].append(item)
        elif item.requirement not in requirements:
            groups[f"requirement {item.requirement}"].append(item)
        else:
            groups[f"{item.requirement} in {item.scenario}"].append(item)
    return tuple(Group(name, tuple(some)) for name, some in groups.items())


def gone(trends: Trends) -> tuple[Group, ...]:
    """Items that were judged before, and are not in the newest round."""
    return grouped(trends, VerdictChange.GONE)


def not_selected(trends: Trends) -> tuple[Group, ...]:
    """Items that were judged before, in logs that the selection may have left out."""
    return grouped(trends, VerdictChange.NOT_SELECTED)


def arrived(trends: Trends) -> tuple[Group, ...]:
    """Items that were never judged before; violated ones are also reported one by one."""
    return grouped(trends, VerdictChange.FIRST, VerdictChange.FIRST_VIOLATED)


def trends(
    sources: Sequence[EvidenceSource], by: str | None = None, level: float = LEVEL
) -> Trends | Diagnostic:
    """Compare all rounds.

    Args:
        sources: the evidence, at least one.
        by: the kind of rounds (`fretc.trends.histories.histories`).
        level: the probability of even one false regression.
    """
    if by not in (None, EVIDENCE, DAY) and not any(
        by in facts.labels for source in sources for facts in source.runs()
    ):
        return diagnostic("no_run_with_label", by=by)
    read_histories = histories(sources, by)
    items = [_item(read_histories, *key, judged) for key, judged in read_histories.judged.items()]
    order = list(VerdictChange)
    items.sort(
        key=lambda item: (
            order.index(item.change),
            natural(item.requirement),
            natural(item.scenario.name),
        )
    )
    compared = compared_runs(read_histories)
    return Trends(
        read_histories.by,
        read_histories.rounds,
        read_histories.requirements,
        tuple(items),
        compared,
        comparisons(read_histories, compared, level),
        level,
        tuple(compared.is_after(run) for run in read_histories.runs),
        read_histories.order,
    )


def _item(
    known: Histories, requirement: str, scenario: ComparableRuns, judged: Sequence[RunOutcome]
) -> Item:
    rounds = verdicts_of_rounds(judged, len(known.rounds))
    verdict_inputs = max(judged, key=lambda one: one.round).verdict_inputs
    comparable = [outcome for outcome in judged if outcome.verdict_inputs == verdict_inputs]
    of_software: dict[str, list[str]] = defaultdict(list)
    for one in comparable:
        software = known.runs[one.run].software if one.run >= 0 else f"all of {one.round}"
        of_software[software].append(one.verdict)
    same = verdicts_of_rounds(comparable, len(known.rounds))
    became = change(rounds)
    return Item(
        requirement,
        scenario,
        VerdictChange.NOT_SELECTED if is_left_out(known, requirement, judged, became) else became,
        is_flaky(same, of_software),
        len(comparable) < len(judged),
        rounds,
    )
