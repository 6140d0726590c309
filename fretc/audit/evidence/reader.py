"""The evidence file as checked values, or the reason why it cannot be read.

Nothing in the file is trusted: what its types (`fretc.audit.evidence.schema`) do not have is F503,
never a report about half of it.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property

from compiler.files.checked_json import SchemaError, parsed
from compiler.files.records import UnsetType, decoded
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from fretc.audit.evidence.result_summaries import (
    EvidenceSource,
    ResultSummary,
    RunFacts,
    run_facts,
    summary_of,
)
from fretc.audit.evidence.schema import (
    EvidenceDocument,
    Result,
    Situations,
    ThresholdRecord,
)
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source
from monitors import kernel

VERDICTS = (
    kernel.VIOLATED,
    ASSUMPTION_BROKEN,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    kernel.SATISFIED,
)
"""The verdicts, the worst first."""


@dataclass(frozen=True)
class EvidenceFile(EvidenceSource):
    """An evidence file in memory."""

    @property
    def results(self) -> tuple[Result, ...]:
        """One result for each run and requirement."""
        return self.document.results

    def summaries(self) -> Iterator[tuple[int, ResultSummary]]:
        """The summary of each result with its index, in order."""
        for index, result in enumerate(self.results):
            yield index, summary_of(result)

    def runs(self) -> Iterator[RunFacts]:
        """The facts of each run, in the order of their first results."""
        results_of: dict[tuple[str, str], list[Result]] = {}
        for result in self.results:
            key = result.run, result.fingerprints.log or ""
            results_of.setdefault(key, []).append(result)
        yield from map(run_facts, results_of.values())

    def details(self, indices: Collection[int]) -> Iterator[tuple[int, Result]]:
        """The whole results at the given indices, in order."""
        for index in sorted({*indices}):
            yield index, self.results[index]

    def latencies(self, requirements: Collection[str]) -> Iterator[tuple[int, Sequence[float]]]:
        """Latencies in seconds of each result of some requirements, with its index, in order."""
        for index, result in self._of(requirements):
            yield index, result.latencies

    def thresholds(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Sequence[ThresholdRecord]]]:
        """The thresholds of each result of some requirements, with its index, in order."""
        for index, result in self._of(requirements):
            yield index, result.thresholds

    def situations(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Situations | UnsetType]]:
        """The situations that each result of some requirements shows, with its index, in order."""
        for index, result in self._of(requirements):
            yield index, result.situations

    def _of(self, requirements: Collection[str]) -> Iterator[tuple[int, Result]]:
        return self.details([at for id in {*requirements} for at in self._places.get(id, ())])

    @cached_property
    def _places(self) -> Mapping[str, Sequence[int]]:
        """The indices of the results of each requirement."""
        indices_of: dict[str, list[int]] = {}
        for index, result in enumerate(self.results):
            indices_of.setdefault(result.requirement, []).append(index)
        return indices_of


def read(path: str) -> EvidenceFile | Diagnostic:
    """Read and check an evidence file; a note, not an error, if it does not exist yet."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return not_audited(path) if source.code is Code.NO_SUCH_FILE else source
    return _parsed(source)


def _parsed(source: Source) -> EvidenceFile | Diagnostic:
    path = source.name
    try:
        file = parsed(source.text)
    except json.JSONDecodeError as error:
        return _not_json(source, error)
    except (ValueError, RecursionError) as error:
        return _wrong(path, f"is not JSON that fretc can read: {_why(error)}")
    try:
        return EvidenceFile(source.name, sha256(source.text), decoded(file.value, EvidenceDocument))
    except SchemaError as error:
        return _wrong(path, f"is not evidence of fretc: {error}")


def not_audited(path: str) -> Diagnostic:
    """F901 as a note: a report before the first audit has no results."""
    return Diagnostic(
        Code.NO_SUCH_FILE,
        f"no run has been audited: there is no evidence in `{path}`",
        help=f"audit a run: `fretc audit LOG... -o {path}`",
        severity=Severity.NOTE,
    )


def _not_json(source: Source, error: json.JSONDecodeError) -> Diagnostic:
    at = min(error.pos, max(0, len(source.text) - 1))
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"the evidence is not JSON: {error.msg[:1].lower()}{error.msg[1:]}",
        source.span(at, at + 1),
        help=f"audit again: `fretc audit LOG... -o {source.name}`",
    )


def _wrong(path: str, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... -o {path}`",
    )


def _why(error: Exception) -> str:
    return "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
