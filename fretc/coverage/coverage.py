"""Which situations of each requirement recorded runs came by, from the evidence of their audit.

Seen is what is certain; what may only have been there is `perhaps`; and a run whose audit did not
look, or could not, is counted apart: it has neither seen anything nor shown that nothing was there.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from fretc.audit.evidence.briefs import EvidenceSource
from fretc.audit.evidence.schema import Moment
from fretc.audit.evidence.schema import Situation as Named
from fretc.coverage.least_runs import LeastRuns, least_runs


class Standing(Enum):
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
    standing: Standing


@dataclass(frozen=True, slots=True)
class RequirementCoverage:
    """The situations of a requirement over all runs."""

    id: str
    situations: tuple[RecordedSituation, ...]
    measured: tuple[int, ...]
    """The places of the runs that were looked at."""
    unmeasured: tuple[int, ...]
    """Those of the others that have a result."""

    def of(self, standing: Standing) -> tuple[RecordedSituation, ...]:
        """The situations of which the runs show this."""
        return tuple(each for each in self.situations if each.standing is standing)

    @property
    def text(self) -> str:
        """`7 of 11 situations seen; perhaps: ...; never: ...`."""
        if not self.situations:
            return "situations not measured"
        seen, every = len(self.of(Standing.SEEN)), len(self.situations)
        if not self.measured:
            return f"0 of {every} situations seen: not measured"
        parts = [f"{seen} of {every} situations seen"]
        for standing in (Standing.PERHAPS, Standing.NEVER):
            words = ", ".join(each.words for each in self.of(standing))
            parts += [f"{standing.value}: {words}"] if words else []
        return "; ".join(parts)


@dataclass(frozen=True, slots=True)
class Coverage:
    """What all runs of an audit have exercised."""

    runs: tuple[str, ...]
    requirements: tuple[RequirementCoverage, ...]
    least: LeastRuns
    """Runs that came by all that the runs together came by."""

    @property
    def is_complete(self) -> bool:
        """Whether every situation of every requirement has been seen."""
        return all(
            each.situations and len(each.of(Standing.SEEN)) == len(each.situations)
            for each in self.requirements
        )


def coverage(source: EvidenceSource) -> Coverage:
    """What the runs of some evidence have exercised.

    Args:
        source: in which the results of a run stand together.

    Raises:
        StoreError: it turns out not to be what it must be.
    """
    names, run_of = _runs(source)
    found = tuple(
        of_requirement(source, each.id, tuple(each.situations or ()), run_of)
        for each in source.requirements
    )
    aims = [frozenset(each.seen) for one in found for each in one.of(Standing.SEEN)]
    return Coverage(names, found, least_runs(aims))


def _runs(source: EvidenceSource) -> tuple[tuple[str, ...], Mapping[int, int]]:
    """The names of the runs, and the run of each result by the place of the result."""
    names: list[str] = []
    known: dict[tuple[str, str], int] = {}
    run_of: dict[int, int] = {}
    for place, brief in source.briefs():
        key = brief.run, brief.content
        if key not in known:
            known[key] = len(names)
            names.append(brief.run)
        run_of[place] = known[key]
    return tuple(names), run_of


def of_requirement(
    source: EvidenceSource,
    id: str,
    situations: Sequence[Named],
    run_of: Mapping[int, int],
) -> RequirementCoverage:
    """What some results show of one requirement.

    Args:
        source: has them.
        id: of the requirement.
        situations: all that it has, in their order.
        run_of: place of a result → its run; results that are not in it do not count.
    """
    measured: list[int] = []
    unmeasured: list[int] = []
    seen: dict[str, dict[int, Moment]] = {each.key: {} for each in situations}
    perhaps: dict[str, dict[int, Moment]] = {each.key: {} for each in situations}
    for place, shown in source.situations([id]):
        run = run_of.get(place)
        if run is None:
            continue
        (measured if shown else unmeasured).append(run)
        for table, moments in ((seen, shown.seen), (perhaps, shown.perhaps)) if shown else ():
            for key, moment in moments.items():
                if key in table:
                    table[key].setdefault(run, moment)
    return RequirementCoverage(
        id,
        tuple(
            RecordedSituation(
                each.key,
                each.words,
                seen[each.key],
                perhaps[each.key],
                _standing(seen[each.key], perhaps[each.key], measured),
            )
            for each in situations
        ),
        tuple(dict.fromkeys(measured)),
        tuple(dict.fromkeys(unmeasured)),
    )


def _standing(
    seen: Mapping[int, Moment], perhaps: Mapping[int, Moment], measured: Collection[int]
) -> Standing:
    if seen:
        return Standing.SEEN
    if perhaps:
        return Standing.PERHAPS
    return Standing.NEVER if measured else Standing.NOT_MEASURED


def unseen(covered: Coverage) -> Iterator[tuple[RequirementCoverage, RecordedSituation]]:
    """Every situation that no run has shown for certain, in order."""
    for requirement in covered.requirements:
        for situation in requirement.situations:
            if situation.standing is not Standing.SEEN:
                yield requirement, situation
