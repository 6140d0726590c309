"""Which situations of each requirement recorded runs came by, from the evidence of their audit.

Seen is what is certain; what may only have been there is `perhaps`; and a run whose audit did not
look, or could not, is counted apart: it has neither seen anything nor shown that nothing was there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from compiler.files.records import UnsetType
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import Moment, Requirement, Situations
from fretc.audit.evidence.schema import Situation as Named
from fretc.coverage.least_runs import LeastRuns, least_runs


class CoverageStatus(StrEnum):
    """What all runs together show of a situation."""

    SEEN = "seen"
    """In some run it was certainly there."""
    PERHAPS = "perhaps"
    """In some run it may have been: something is unknown there."""
    NEVER = "never"
    """In no run that was looked at."""
    NOT_MEASURED = "not measured"
    """No run was looked at."""


@dataclass(frozen=True, slots=True)
class RecordedSituation:
    """A situation of a requirement, and the runs that came by it."""

    key: str
    words: str
    seen: Mapping[int, Moment]
    """The first tick in each run, by the place of the run."""
    perhaps: Mapping[int, Moment]
    """The same of others, where it may have been."""
    standing: CoverageStatus


@dataclass(frozen=True, slots=True)
class RequirementCoverage:
    """The situations of a requirement over all runs."""

    id: str
    fingerprint: str
    """SHA-256 of its sentence."""
    situations: tuple[RecordedSituation, ...]
    measured: tuple[int, ...]
    """The places of the runs that were looked at."""
    unmeasured: tuple[int, ...]
    """Those of the others that have a result."""

    def of(self, standing: CoverageStatus) -> tuple[RecordedSituation, ...]:
        """The situations of which the runs show this."""
        return tuple(each for each in self.situations if each.standing is standing)


@dataclass(frozen=True, slots=True)
class Coverage:
    """What all runs of an audit have exercised."""

    runs: tuple[str, ...]
    requirements: tuple[RequirementCoverage, ...]
    least: LeastRuns
    """Runs that came by all that the runs together came by."""


def coverage(source: EvidenceSource) -> Coverage:
    """What the runs of some evidence have exercised, and which of them would be enough for that.

    Args:
        source: in which the results of a run stand together.

    Raises:
        StoreError: it turns out not to be what it must be.
    """
    names, found = of_all_runs(source)
    aims = [frozenset(each.seen) for one in found for each in one.of(CoverageStatus.SEEN)]
    return Coverage(names, found, least_runs(aims))


def of_all_runs(
    source: EvidenceSource,
) -> tuple[tuple[str, ...], tuple[RequirementCoverage, ...]]:
    """The names of the runs, and what they show of each requirement."""
    names: list[str] = []
    known: dict[tuple[str, str], int] = {}
    places: dict[str, dict[int, int]] = {}
    for place, brief in source.briefs():
        key = brief.run, brief.content
        if key not in known:
            known[key] = len(names)
            names.append(brief.run)
        places.setdefault(brief.requirement, {})[place] = known[key]
    return tuple(names), of_requirements(source, places)


def of_requirements(
    source: EvidenceSource, places: Mapping[str, Mapping[int, int]]
) -> tuple[RequirementCoverage, ...]:
    """What some results show of each requirement of the evidence, in their order.

    Args:
        source: has them.
        places: requirement → the place of each result that counts → its run.
    """
    ledgers = {each.id: _Ledger(each) for each in source.requirements}
    of_place = {place: id for id, some in places.items() for place in some}
    for place, shown in source.situations(ledgers.keys()):
        id = of_place.get(place)
        if id in ledgers:
            ledgers[id].add(places[id][place], shown)
    return tuple(each.coverage() for each in ledgers.values())


class _Ledger:
    """What is known of one requirement, while results are read."""

    def __init__(self, requirement: Requirement) -> None:
        self._id, self._fingerprint = requirement.id, requirement.sha256
        self._situations = requirement.situations or ()
        self._seen: dict[str, dict[int, Moment]] = {each.key: {} for each in self._situations}
        self._perhaps: dict[str, dict[int, Moment]] = {each.key: {} for each in self._situations}
        self._measured: dict[int, None] = {}
        self._unmeasured: dict[int, None] = {}

    def add(self, run: int, shown: Situations | UnsetType) -> None:
        """One more result."""
        if not shown:
            self._unmeasured[run] = None
            return
        self._measured[run] = None
        for table, moments in ((self._seen, shown.seen), (self._perhaps, shown.perhaps)):
            for key, moment in moments.items():
                if key in table:
                    table[key].setdefault(run, moment)

    def coverage(self) -> RequirementCoverage:
        """All of it."""
        situations = tuple(map(self._situation, self._situations))
        return RequirementCoverage(
            self._id, self._fingerprint, situations, tuple(self._measured), tuple(self._unmeasured)
        )

    def _situation(self, one: Named) -> RecordedSituation:
        seen, perhaps = self._seen[one.key], self._perhaps[one.key]
        perhaps = {run: moment for run, moment in perhaps.items() if run not in seen}
        standing = CoverageStatus.NEVER if self._measured else CoverageStatus.NOT_MEASURED
        if seen or perhaps:
            standing = CoverageStatus.SEEN if seen else CoverageStatus.PERHAPS
        return RecordedSituation(one.key, one.words, seen, perhaps, standing)


def counts(requirements: Iterable[RequirementCoverage]) -> Counter[CoverageStatus]:
    """How many situations of all requirements there are of each standing."""
    return Counter(each.standing for one in requirements for each in one.situations)
