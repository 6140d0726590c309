"""Situations of each requirement that recorded runs have shown, from audit evidence.

A situation is `seen` if a run certainly shows it, and `perhaps` if that depends on unknown values.
Runs whose audit did not measure situations are counted separately.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING

from compiler.files.records import UnsetType
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import Moment, RequirementRecord, Situations
from fretc.audit.evidence.schema import SituationRecord as Named
from fretish.classes.frozen import dataclass

if TYPE_CHECKING:
    from fretc.coverage.least_runs import LeastRuns


class CoverageStatus(StrEnum):
    """The status of a situation over all runs."""

    SEEN = "seen"
    """At least one run certainly shows the situation."""
    PERHAPS = "perhaps"
    """A run may show the situation, depending on unknown values."""
    NEVER = "never"
    """No measured run shows the situation."""
    NOT_MEASURED = "not measured"
    """No run was measured."""


@dataclass(frozen=True, slots=True)
class RecordedSituation:
    """A situation of a requirement, and the runs that show it."""

    key: str
    words: str
    seen: Mapping[int, Moment]
    """Index of a run → first tick that certainly shows the situation."""
    perhaps: Mapping[int, Moment]
    """Index of another run → first tick that may show the situation."""
    status: CoverageStatus


@dataclass(frozen=True, slots=True)
class RequirementCoverage:
    """The situations of a requirement over all runs."""

    id: str
    fingerprint: str
    """SHA-256 of the sentence."""
    situations: tuple[RecordedSituation, ...]
    measured: tuple[int, ...]
    """The indices of the runs that were measured."""
    unmeasured: tuple[int, ...]
    """The indices of other runs with a result."""

    def of(self, status: CoverageStatus) -> tuple[RecordedSituation, ...]:
        """The situations with this status."""
        return tuple(situation for situation in self.situations if situation.status is status)


@dataclass(frozen=True, slots=True)
class Coverage:
    """The coverage of all requirements by the runs of an audit."""

    runs: tuple[str, ...]
    requirements: tuple[RequirementCoverage, ...]
    least: LeastRuns
    """A small set of runs that shows every situation that all runs show."""


def coverage(source: EvidenceSource) -> Coverage:
    """The coverage by the runs of evidence, with a small set of runs that has the same coverage.

    Args:
        source: evidence in which the results of a run are adjacent.

    Raises:
        StoreError: the store is damaged.
    """
    from fretc.coverage.least_runs import least_runs

    names, found = of_all_runs(source)
    aims = [
        frozenset(situation.seen) for item in found for situation in item.of(CoverageStatus.SEEN)
    ]
    return Coverage(names, found, least_runs(aims))


def of_all_runs(
    source: EvidenceSource,
) -> tuple[tuple[str, ...], tuple[RequirementCoverage, ...]]:
    """The names of the runs, and the coverage of each requirement."""
    names: list[str] = []
    known: dict[tuple[str, str], int] = {}
    places: dict[str, dict[int, int]] = {}
    for index, summary in source.summaries():
        key = summary.run, summary.content
        if key not in known:
            known[key] = len(names)
            names.append(summary.run)
        places.setdefault(summary.requirement, {})[index] = known[key]
    return tuple(names), of_requirements(source, places)


def of_requirements(
    source: EvidenceSource, places: Mapping[str, Mapping[int, int]]
) -> tuple[RequirementCoverage, ...]:
    """The coverage of each requirement by some results, in the order of the evidence.

    Args:
        source: the evidence.
        places: requirement → index of each counted result → index of its run.
    """
    ledgers = {requirement.id: _Ledger(requirement) for requirement in source.requirements}
    of_place = {index: id for id, some in places.items() for index in some}
    for index, shown in source.situations(ledgers.keys()):
        id = of_place.get(index)
        if id in ledgers:
            ledgers[id].add(places[id][index], shown)
    return tuple(ledger.coverage() for ledger in ledgers.values())


class _Ledger:
    """Accumulates the coverage of one requirement while results are read."""

    def __init__(self, requirement: RequirementRecord) -> None:
        self._id, self._fingerprint = requirement.id, requirement.sha256
        self._situations = requirement.situations or ()
        self._seen: dict[str, dict[int, Moment]] = {
            situation.key: {} for situation in self._situations
        }
        self._perhaps: dict[str, dict[int, Moment]] = {
            situation.key: {} for situation in self._situations
        }
        self._measured: dict[int, None] = {}
        self._unmeasured: dict[int, None] = {}

    def add(self, run: int, shown: Situations | UnsetType) -> None:
        """Add the situations of one result."""
        if not shown:
            self._unmeasured[run] = None
            return
        self._measured[run] = None
        for table, moments in ((self._seen, shown.seen), (self._perhaps, shown.perhaps)):
            for key, moment in moments.items():
                if key in table:
                    table[key].setdefault(run, moment)

    def coverage(self) -> RequirementCoverage:
        """The coverage of all added results."""
        situations = tuple(map(self._situation, self._situations))
        return RequirementCoverage(
            self._id, self._fingerprint, situations, tuple(self._measured), tuple(self._unmeasured)
        )

    def _situation(self, one: Named) -> RecordedSituation:
        seen, perhaps = self._seen[one.key], self._perhaps[one.key]
        perhaps = {run: moment for run, moment in perhaps.items() if run not in seen}
        status = CoverageStatus.NEVER if self._measured else CoverageStatus.NOT_MEASURED
        if seen or perhaps:
            status = CoverageStatus.SEEN if seen else CoverageStatus.PERHAPS
        return RecordedSituation(one.key, one.words, seen, perhaps, status)


def counts(requirements: Iterable[RequirementCoverage]) -> Counter[CoverageStatus]:
    """The number of situations of all requirements by status."""
    return Counter(
        situation.status for requirement in requirements for situation in requirement.situations
    )
