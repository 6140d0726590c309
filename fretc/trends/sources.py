"""The evidence that is compared: several files, each read whole."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from fretc.audit.evidence.briefs import Brief, EvidenceSource, RunFacts, brief, run_facts
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.reader import required
from fretc.audit.evidence.schema import Bindings, Evidence, Requirement, Result, Threshold
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class InMemory:
    """Evidence of one file as a source."""

    evidence: Evidence

    @property
    def file(self) -> str:
        """Its name, as the user gave it."""
        return self.evidence.file

    @property
    def sha256(self) -> str:
        """Of the file."""
        return self.evidence.sha256

    @property
    def fretc(self) -> str:
        """Version of the tool that audited."""
        return self.evidence.fretc

    @property
    def bindings(self) -> Bindings:
        """Those that the logs were read by."""
        return self.evidence.document.bindings

    @property
    def requirements(self) -> Sequence[Requirement]:
        """Of the audit."""
        return self.evidence.document.requirements

    @property
    def probabilities(self) -> Sequence[Estimated]:
        """What all runs say of each requirement with a probability."""
        return self.evidence.probabilities

    def briefs(self) -> Iterator[tuple[int, Brief]]:
        """Each result with its place, in order."""
        return ((place, brief(each)) for place, each in enumerate(self.evidence.results))

    def runs(self) -> Iterator[RunFacts]:
        """The facts of each run, in the order of their first results."""
        for _, results in groupby(self.evidence.results, lambda result: result.run):
            yield run_facts(tuple(results))

    def details(self, places: Collection[int]) -> Iterator[tuple[int, Result]]:
        """The whole results at some places, in order."""
        return ((place, self.evidence.results[place]) for place in sorted(places))

    def latencies(self, requirement: str) -> Iterator[tuple[int, Sequence[float]]]:
        """The latencies in seconds of each result of a requirement, with its place, in order."""
        return ((place, each.latencies) for place, each in self._of(requirement))

    def thresholds(self, requirement: str) -> Iterator[tuple[int, Sequence[Threshold]]]:
        """The thresholds of each result of a requirement, with its place, in order."""
        return ((place, each.thresholds) for place, each in self._of(requirement))

    def _of(self, requirement: str) -> Iterator[tuple[int, Result]]:
        results = enumerate(self.evidence.results)
        return ((place, each) for place, each in results if each.requirement == requirement)


def source(path: str) -> EvidenceSource | Diagnostic:
    """The evidence at a path; an error where there is none."""
    evidence = required(path)
    return evidence if isinstance(evidence, Diagnostic) else InMemory(evidence)
