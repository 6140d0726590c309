"""A store as it is read: run by run, each record compared with its hash.

Nothing in it is trusted: what does not fit its hash, or what no evidence has, is F516, never half a
report. Counts and verdicts are taken from the records themselves, and each summary that does not
fit its record is F516, too. Only queries and the end of an audit take them from the summaries, of
a store whose every run the user's key authenticates (`fretc.audit.store.register`).
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace as replace_fields
from functools import cached_property
from itertools import accumulate, chain, groupby
from pathlib import Path
from typing import TypeVar

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import (
    UNSET,
    Name,
    Raw,
    Seconds,
    UnsetType,
    decoded,
    field,
    replace,
)
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import (
    CountedResult,
    EvidenceSource,
    PartialRecord,
    ResultSummary,
    RunFacts,
    SharedFacts,
    facts_of_parts,
)
from fretc.audit.evidence.schema import (
    EvidenceDocument,
    Health,
    Labels,
    Result,
    Situations,
    ThresholdRecord,
    Violation,
)
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.store import container, earlier_store, register
from fretc.audit.store.container import (
    FILE,
    Row,
    StoreError,
    bad_store,
    check_record,
    identity,
    record_of,
    strict,
    summary_of,
    unfinished,
    unpacked,
    unpacked_summary,
    whole_results,
)
from fretc.audit.store.run_summaries import RunSummary, facts_from, summary_from, summary_of_parts
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic

T = TypeVar("T")


class _Latencies(PartialRecord, frozen=True):
    requirement: Name
    latencies: tuple[Seconds, ...] = field(name="latencies_s")


class _Thresholds(PartialRecord, frozen=True):
    requirement: Name
    thresholds: Raw


class _Situations(PartialRecord, frozen=True):
    requirement: Name
    situations: Raw | UnsetType = UNSET


class _Violations(PartialRecord, frozen=True):
    requirement: Name
    violations: Raw


@dataclass(frozen=True)
class Store(EvidenceSource):
    """Evidence in a store. The methods that read records raise `StoreError`."""

    path: Path
    """The container."""
    rows: Sequence[Row]
    by_summaries: bool = False
    """Whether summaries, facts and tallies are those that the audit wrote, without a look at the
    records: the user's key authenticates them, or they were compared with the records before."""

    def summaries(self) -> Iterator[tuple[int, ResultSummary]]:
        """The summary of each result with its index, in order; the results of a run adjoin."""
        return enumerate(chain.from_iterable(run.results for run in self.run_summaries()))

    def runs(self) -> Iterator[RunFacts]:
        """The facts of each run, in the order of their first results."""
        if not self.by_summaries:
            yield from (facts_of_parts(results, shared) for shared, results in self._counted())
            return
        for text in self._summary_texts():
            assert text is not None
            with self._valid():
                facts = facts_from(text)
            yield facts

    def after_summaries(self) -> Store:
        """The store, once all its summaries have been compared with their records.

        Each time that a summary is read, its hash is compared; so it is one that was compared.
        """
        has_all = all(row.summary_sha256 is not None for row in self.rows)
        return replace_fields(self, by_summaries=True) if has_all else self

    def tallies(self) -> Iterator[dict[str, PropositionTally]]:
        """The tally of each proposition in each run."""
        return (run.tallies for run in self.run_summaries())

    def run_summaries(self) -> Iterator[RunSummary]:
        """The summary of each run, in order."""
        if self.by_summaries:
            for row, text in zip(self.rows, self._summary_texts(), strict=True):
                assert text is not None
                with self._valid():
                    found = summary_from(text, row.results)
                yield found
        else:
            runs = zip(self._counted(), self._summary_texts(), strict=True)
            for (shared, results), text in runs:
                yield self._summary(results, shared, text)

    def _summary(
        self,
        results: Sequence[Result | CountedResult],
        shared: Result | SharedFacts,
        text: bytes | None,
    ) -> RunSummary:
        """The summary of all results of a run.

        Args:
            results: those of its record.
            shared: what they have in common.
            text: the JSON of its summary, which is compared; None: it has none.
        """
        found = summary_of_parts(results, shared)
        with self._valid():
            if text is not None and found.text != text:
                raise SchemaError("a summary contradicts its record")
        return found

    def _counted(self) -> Iterator[tuple[SharedFacts, list[CountedResult]]]:
        for run in self._runs(CountedResult):
            with self._valid():
                labels = UNSET if run.labels is UNSET else strict(run.labels, Labels)
                shared = SharedFacts(run.run, strict(run.health, Health), labels)
                if any(each.run or each.labels for each in run.results):
                    raise SchemaError("a result has a fact of its run")
            yield shared, run.results

    def details(self, indices: Collection[int]) -> Iterator[tuple[int, Result]]:
        """The whole results at the given indices, in order."""
        starts = self._starts
        of_row = {
            row: [*group]
            for row, group in groupby(sorted({*indices}), lambda n: bisect_right(starts, n) - 1)
        }
        chosen = [*of_row]
        texts = self._summary_texts(chosen)
        for row, run, text in zip(chosen, self._runs(Raw, chosen), texts, strict=True):
            with self._valid():
                own = [index - starts[row] for index in of_row[row]]
                results = [*whole_results(run, own)]
            if len(results) == self.rows[row].results:
                self._summary(results, results[0], text)
            yield from zip(of_row[row], results, strict=True)

    def results(self) -> Iterator[Result]:
        """All results, in order."""
        count = sum(row.results for row in self.rows)
        yield from (result for _, result in self.details(range(count)))

    def latencies(self, requirements: Collection[str]) -> Iterator[tuple[int, Sequence[float]]]:
        """Latencies in seconds of each result of some requirements, with its index, in order."""
        for index, each in enumerate(self._parts(_Latencies)):
            if each.requirement in requirements:
                yield index, each.latencies

    def thresholds(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Sequence[ThresholdRecord]]]:
        """The thresholds of each result of some requirements, with its index, in order."""
        for index, each in enumerate(self._parts(_Thresholds)):
            if each.requirement in requirements:
                with self._valid():
                    thresholds = strict(each.thresholds, list[ThresholdRecord])
                yield index, thresholds

    def situations(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Situations | UnsetType]]:
        """The situations that each result of some requirements shows, with its index, in order."""
        for index, each in enumerate(self._parts(_Situations)):
            if each.requirement in requirements:
                raw = each.situations
                with self._valid():
                    situations = UNSET if raw is UNSET else strict(raw, Situations)
                yield index, situations

    def violations(self) -> Iterator[tuple[str, str, Sequence[Violation]]]:
        """Run, requirement and violations of each result that has some."""
        for run in self._runs(_Violations):
            for each in run.results:
                with self._valid():
                    violations = strict(each.violations, list[Violation])
                if violations:
                    yield run.run, each.requirement, violations

    def _parts(self, kind: type[T]) -> Iterator[T]:
        return (each for run in self._runs(kind) for each in run.results)

    @cached_property
    def _starts(self) -> Sequence[int]:
        """The index of the first result of each run."""
        return [0, *accumulate(row.results for row in self.rows)][: len(self.rows)]

    def _runs(
        self, kind: type[T], chosen: Sequence[int] | None = None
    ) -> Iterator[container.RunRecord[T]]:
        """The record of each run, or of some, in order.

        Args:
            kind: what is decoded of each result.
            chosen: indices of runs, in order; None: all.
        """
        with self._valid(), container.opened(self.path) as connection:
            for row in self._chosen(chosen):
                record = record_of(connection, row.place)
                yield unpacked(row, record, kind, known=self.by_summaries)

    def _summary_texts(self, chosen: Sequence[int] | None = None) -> Iterator[bytes | None]:
        """The JSON of the summary of each run, or of some, in order; None: it has none."""
        with self._valid(), container.opened(self.path) as connection:
            for row in self._chosen(chosen):
                has_one = row.summary_sha256 is not None
                yield unpacked_summary(row, summary_of(connection, row.place)) if has_one else None

    def _chosen(self, chosen: Sequence[int] | None) -> Sequence[Row]:
        return self.rows if chosen is None else [self.rows[n] for n in chosen]

    @contextmanager
    def _valid(self) -> Iterator[None]:
        try:
            yield
        except SchemaError as error:
            raise StoreError(bad_store(self.file, f"cannot be read: {error}")) from None


def opened(path: str, key: bytes | None = None) -> Store | EvidenceFile | Diagnostic:
    """A store with the records that its head names; one with Parquet tables is read into memory.

    Args:
        path: the folder of the store.
        key: of the user: a store that it authenticates is counted by its summaries; None: every
            store is counted by its records.
    """
    file = Path(path, FILE)
    if not os.path.lexists(file):
        if earlier_store.is_store(file.parent):
            return earlier_store.read(path)
        why = ": its audit was not finished" if unfinished(Path(path)) else ""
        return bad_store(path, f"has no `{FILE}`{why}")
    try:
        with container.opened(file) as connection:
            ((text, sha256),) = connection.execute("SELECT head, sha256 FROM about LIMIT 2")
            if text is None:
                raise SchemaError("its audit was not finished")
            head, rows = decoded(parsed(text), EvidenceDocument), container.rows(connection)
            if identity(text, rows) != sha256 or head.results:
                raise SchemaError("its runs are not those of its head")
            by_summaries = key is not None and register.is_authentic(connection, file.parent, key)
            for row in () if by_summaries else rows:
                check_record(row, record_of(connection, row.place))
    except (SchemaError, ValueError, TypeError) as error:
        return bad_store(path, f"cannot be read: {error}")
    name = str(Path(path))  # signatures are beside it
    return Store(name, sha256, head, file, rows, by_summaries)


def evidence(store: Store) -> EvidenceFile:
    """The whole store in memory.

    Raises:
        StoreError: the store cannot be read.
    """
    document = replace(store.document, results=tuple(store.results()))
    return EvidenceFile(store.file, store.sha256, document)
