"""What has become of everything between the rounds: one value, for text, JSON and page."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fretc.audit.evidence.briefs import EvidenceSource
from fretc.trends.changes import RED, Change, Tone, change, is_flaky, last_known, tone
from fretc.trends.comparisons import (
    LEVEL,
    Comparison,
    Finding,
    Sides,
    comparisons,
    sides,
)
from fretc.trends.histories import (
    DAY,
    EVIDENCE,
    Histories,
    Judged,
    Round,
    Scenario,
    histories,
    verdicts_of_rounds,
)
from fretc.trends.left_out import is_left_out
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.reading.natural_order import natural


@dataclass(frozen=True, slots=True)
class Item:
    """A requirement in a scenario, and what has become of it."""

    requirement: str
    scenario: Scenario
    change: Change
    flaky: bool
    changed: bool
    """Whether the requirement, or what it is bound to, is not the one of an earlier round."""
    rounds: tuple[tuple[str, ...], ...]
    """The verdicts of each round, the newest last."""

    @property
    def tones(self) -> tuple[Tone | None, ...]:
        """What each round says; None: it does not judge it."""
        return tuple(tone(verdicts) if verdicts else None for verdicts in self.rounds)

    @property
    def was_violated(self) -> bool:
        """Whether it was violated when something was known of it before the newest round."""
        last = last_known(self.rounds)
        return last is not None and self.tones[last] is Tone.VIOLATED

    @property
    def last(self) -> Tone:
        """What was said of it last, in a round that had the runs of which it was said."""
        if self.change is Change.NOT_SELECTED and self.was_violated:
            return Tone.VIOLATED
        return next(filter(None, reversed(self.tones)))


@dataclass(frozen=True, slots=True)
class Trends:
    """All of it."""

    by: str
    rounds: tuple[Round, ...]
    sentences: Mapping[str, str]
    """Id of a requirement → its sentence."""
    items: tuple[Item, ...]
    """The worst first."""
    held: Sides
    comparisons: tuple[Comparison, ...]
    level: float
    is_after: tuple[bool, ...]
    """Of each run, whether it is of what is compared with others."""
    order: str
    """By what rounds are ordered, in words."""

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.is_after)

    def of(self, *kinds: Change) -> tuple[Item, ...]:
        """The items of some kinds."""
        return tuple(item for item in self.items if item.change in kinds)

    def found(self, kind: Finding) -> tuple[Comparison, ...]:
        """The comparisons of a finding."""
        return tuple(one for one in self.comparisons if one.finding is kind)

    @property
    def is_worse(self) -> bool:
        """Whether something is newly violated, or has regressed."""
        return bool(self.of(*RED) or self.found(Finding.REGRESSED))

    @property
    def has_pairs(self) -> bool:
        """Whether something was judged in two rounds."""
        return any(sum(map(bool, item.rounds)) > 1 for item in self.items)

    @property
    def is_comparable(self) -> bool:
        """Whether all that was known before is known now, and something can be compared at all.

        What was not selected, as the user asked for, is missing only where it was violated.
        """
        return self.has_pairs and not self.lost

    @property
    def lost(self) -> tuple[Item, ...]:
        """What was known before and is not known now, though it was to be, or was violated."""
        left_out = (item for item in self.of(Change.NOT_SELECTED) if item.was_violated)
        return (*self.of(Change.LOST, Change.GONE), *left_out)


@dataclass(frozen=True, slots=True)
class Group:
    """Items of one scenario, or of one requirement, of which all have come, or gone."""

    name: str
    """`scenario safety-late`, `requirement R7`, `R7 in safety-late`."""
    items: tuple[Item, ...]

    @property
    def text(self) -> str:
        """With what was said of them last."""
        last = [item.last for item in self.items]
        counts = [f"{last.count(each)} {each}" for each in Tone if each in last]
        return f"{self.name}: {', '.join(counts)}"


def grouped(trends: Trends, *kinds: Change) -> tuple[Group, ...]:
    """Items of some kinds: whole scenarios, whole requirements, then the rest one by one."""
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
    """What was judged before, and is not in the newest round."""
    return grouped(trends, Change.GONE)


def not_selected(trends: Trends) -> tuple[Group, ...]:
    """What was judged before, in logs that the choice of logs may have left out."""
    return grouped(trends, Change.NOT_SELECTED)


def arrived(trends: Trends) -> tuple[Group, ...]:
    """What was never judged before; what is violated of it is reported one by one, too."""
    return grouped(trends, Change.FIRST, Change.FIRST_VIOLATED)


def trends(
    sources: Sequence[EvidenceSource], by: str | None = None, level: float = LEVEL
) -> Trends | Diagnostic:
    """Compare all rounds.

    Args:
        sources: the evidence, at least one.
        by: what a round is (`fretc.trends.histories.histories`).
        level: the chance of even one regression that is none.
    """
    if by not in (None, EVIDENCE, DAY) and not any(
        by in facts.labels for each in sources for facts in each.runs()
    ):
        return Diagnostic(
            Code.NOT_COMPARABLE,
            f"no run has the label `{by}`",
            help="name a label that `[run.label]` or `--label` gives, or `evidence` or `day`",
        )
    known = histories(sources, by)
    items = [_item(known, *key, judged) for key, judged in known.judged.items()]
    order = list(Change)
    items.sort(
        key=lambda item: (
            order.index(item.change),
            natural(item.requirement),
            natural(item.scenario.name),
        )
    )
    held = sides(known)
    return Trends(
        known.by,
        known.rounds,
        known.requirements,
        tuple(items),
        held,
        comparisons(known, held, level),
        level,
        tuple(held.is_after(run) for run in known.runs),
        known.order,
    )


def _item(known: Histories, requirement: str, scenario: Scenario, judged: Sequence[Judged]) -> Item:
    rounds = verdicts_of_rounds(judged, len(known.rounds))
    basis = max(judged, key=lambda one: one.round).basis
    comparable = [one for one in judged if one.basis == basis]
    of_software: dict[str, list[str]] = defaultdict(list)
    for one in comparable:
        software = known.runs[one.run].software if one.run >= 0 else f"all of {one.round}"
        of_software[software].append(one.verdict)
    same = verdicts_of_rounds(comparable, len(known.rounds))
    became = change(rounds)
    return Item(
        requirement,
        scenario,
        Change.NOT_SELECTED if is_left_out(known, requirement, judged, became) else became,
        is_flaky(same, of_software),
        len(comparable) < len(judged),
        rounds,
    )
