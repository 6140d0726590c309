"""What has become of everything between the rounds: one value, for text, JSON and page."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fretc.audit.evidence.briefs import EvidenceSource
from fretc.trends.changes import RED, Change, Tone, change, is_flaky, tone
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
    runs: int
    undated: bool

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
        """Whether all that was known before is known now, and something can be compared at all."""
        return self.has_pairs and not self.of(Change.LOST, Change.GONE)


@dataclass(frozen=True, slots=True)
class Gone:
    """A scenario, or a requirement, that the newest round does not have."""

    text: str
    items: tuple[Item, ...]


def gone(trends: Trends) -> tuple[Gone, ...]:
    """What is gone: whole scenarios, whole requirements, then the rest one by one."""
    items = trends.of(Change.GONE)
    here = [item for item in trends.items if item.change is not Change.GONE]
    scenarios, requirements = {i.scenario for i in here}, {i.requirement for i in here}
    groups: dict[str, list[Item]] = defaultdict(list)
    for item in items:
        if item.scenario not in scenarios:
            groups[f"scenario {item.scenario}"].append(item)
        elif item.requirement not in requirements:
            groups[f"requirement {item.requirement}"].append(item)
        else:
            groups[f"{item.requirement} in {item.scenario}"].append(item)
    return tuple(Gone(_gone_text(name, some), tuple(some)) for name, some in groups.items())


def _gone_text(name: str, items: Sequence[Item]) -> str:
    last = [next(each for each in reversed(item.tones) if each is not None) for item in items]
    violated = last.count(Tone.VIOLATED)
    count = f": {len(items)} verdicts" if len(items) > 1 else ""
    return f"{name}{count}, {violated or 'none'} violated when it was judged last"


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
        len(known.runs),
        known.undated,
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
    return Item(
        requirement,
        scenario,
        change(rounds),
        is_flaky(same, of_software),
        len(comparable) < len(judged),
        rounds,
    )
