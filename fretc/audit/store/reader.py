"""A store as it is read: part by part, each table compared with the manifest.

Nothing in it is trusted: a table that does not fit the manifest, or that holds what no evidence
does, is F516, never half a report.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any, TypeVar

import pyarrow as pa

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import UNSET, UnsetType, decoded, replace
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import HeadProperties, ResultSummary, RunFacts, brief
from fretc.audit.evidence.schema import SCHEMA as EVIDENCE
from fretc.audit.evidence.schema import (
    EvidenceDocument,
    Result,
    Situations,
    ThresholdRecord,
)
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.store import agreement, files, tables
from fretc.audit.store.errors import StoreError
from fretc.audit.store.manifest import (
    FILE,
    REGISTER,
    UNFINISHED,
    Part,
    StoreManifest,
    TableFile,
    place,
)
from fretc.audit.store.manifest import text as manifest_text
from fretc.audit.store.register import Entry, entries, types
from fretc.audit.store.tables import EVENTS, EXACT, RESULTS, RUNS, TABLES, TableName
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source

T = TypeVar("T")
_BEGUN = "its audit was not finished"
_BATCH = 512
"""The number of results that are read at once."""


def opened(path: str, name: str = FILE) -> Store | Diagnostic:
    """A store whose tables match its manifest.

    Args:
        path: the folder of the store.
        name: the file name of the manifest.
    """
    source = read_text(f"{path}/{name}")
    if isinstance(source, Diagnostic):
        if source.code is not Code.NO_SUCH_FILE:
            return source
        is_begun = os.path.exists(f"{path}/{UNFINISHED}")
        return _wrong(path, "has no manifest: " + _BEGUN if is_begun else "has no manifest")
    try:
        store_manifest = decoded(parsed(source.text), StoreManifest)
    except SchemaError as error:
        return _wrong(path, f"has a manifest that fretc did not write: {error}")
    store = Store(
        str(Path(path)), sha256(source.text), store_manifest
    )  # signatures are beside the manifest
    try:
        store.check()
    except StoreError as error:
        return error.diagnostic
    return store


def manifest(folder: Path, name: str) -> StoreManifest | None:
    """A manifest; None: the file does not exist."""
    source = read_text(str(folder / name))
    try:
        return (
            None if isinstance(source, Diagnostic) else decoded(parsed(source.text), StoreManifest)
        )
    except SchemaError:
        return None


@dataclass(frozen=True)
class Store(HeadProperties):
    """An `EvidenceSource`. The methods that read tables raise `StoreError`."""

    file: str
    sha256: str
    manifest: StoreManifest

    @property
    def content_sha256(self) -> str:
        """SHA-256 of the manifest without the register, which has the times of the log files."""
        return sha256(manifest_text(replace(self.manifest, register=UNSET)))

    @property
    def head(self) -> StoreManifest:
        """The facts of the audit as a whole."""
        return self.manifest

    def check(self) -> None:
        """Check every table against the manifest: its bytes, and its number of rows."""
        for part in self.manifest.parts:
            if part.tables.keys() != TABLES.keys():
                raise self._error("lists tables that fretc does not write")
            rows = {name: file.rows for name, file in part.tables.items()}
            if (rows[RESULTS], rows[EVENTS], rows[RUNS]) != (part.results, part.results, part.runs):
                raise self._error("has a manifest that contradicts itself")
            for name in TABLES:
                self._content(name, part.tables[name])
        if self.manifest.register:
            self._content(REGISTER, self.manifest.register)

    def briefs(self) -> Iterator[tuple[int, ResultSummary]]:
        """The summary of each result with its index, in order; the results of a run adjoin."""
        for start, part in self._parts():
            yield from enumerate(self._read(part, RESULTS, tables.briefs), start)

    def runs(self) -> Iterator[RunFacts]:
        """The facts of each run, in the order of their first results."""
        for _, part in self._parts():
            yield from self._read(part, RUNS, tables.facts)

    def details(self, indices: Collection[int]) -> Iterator[tuple[int, Result]]:
        """The whole results at the given indices, in order."""
        wanted = sorted({*indices})
        for start, part in self._parts():
            rows = [at - start for at in wanted if start <= at < start + part.results]
            if rows:
                yield from self._details(part, start, rows)

    def _details(self, part: Part, start: int, rows: Sequence[int]) -> Iterator[tuple[int, Result]]:
        of_part = {name: self._rows(part, name) for name in TABLES}
        for at in range(0, len(rows), _BATCH):
            batch = rows[at : at + _BATCH]
            try:
                counted = of_part[RESULTS].take(pa.array(batch, pa.int64()))
                results = tables.results(of_part, batch)
                if tables.briefs(counted) != [*map(brief, results)]:
                    raise SchemaError("the counts in `results` differ from the other tables")
            except SchemaError as error:
                raise self._error(f"cannot be read: {error}") from None
            yield from zip((start + row for row in batch), results, strict=True)

    def latencies(self, requirements: Collection[str]) -> Iterator[tuple[int, Sequence[float]]]:
        """Latencies in seconds of each result of some requirements, with its index, in order."""
        yield from self._nested(requirements, "latencies_s")

    def thresholds(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Sequence[ThresholdRecord]]]:
        """The thresholds of each result of some requirements, with its index, in order."""
        for at, value in self._nested(requirements, "thresholds"):
            try:
                yield at, decoded(value, list[ThresholdRecord])
            except SchemaError as error:
                raise self._error(f"cannot be read: {error}") from None

    def situations(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Situations | UnsetType]]:
        """The situations that each result of some requirements shows, with its index, in order."""
        for at, value in self._nested(requirements, "situations"):
            try:
                yield at, UNSET if value is None else decoded(value, Situations)
            except SchemaError as error:
                raise self._error(f"cannot be read: {error}") from None

    def _nested(self, requirements: Collection[str], column: str) -> Iterator[tuple[int, Any]]:
        for start, part in self._parts():
            tables_of_part: dict[TableName, pa.Table] = {
                RESULTS: self._table(part, RESULTS, ("requirement", EXACT)),
                EVENTS: self._table(part, EVENTS, (column,)),
            }
            try:
                found = tables.nested(tables_of_part, column, requirements)
            except SchemaError as error:
                raise self._error(f"cannot be read: {error}") from None
            yield from ((start + row, value) for row, value in found)

    def tallies(self) -> Iterator[dict[str, PropositionTally]]:
        """The tally of each proposition in each run."""
        for _, part in self._parts():
            tables_of_part: dict[TableName, pa.Table] = {
                RESULTS: self._table(part, RESULTS, ("run_row",)),
                EVENTS: self._table(part, EVENTS, ("propositions",)),
                RUNS: self._table(part, RUNS, ("run",)),
            }
            try:
                yield from tables.tallies(tables_of_part)
            except (SchemaError, IndexError) as error:
                raise self._error(f"cannot be read: {error}") from None

    def whole(self, name: TableName) -> pa.Table:
        """All rows of a table."""
        tables_of_parts = [self._table(part, name) for _, part in self._parts()]
        return pa.concat_tables([tables.schema(name).empty_table(), *tables_of_parts])

    def counts(self) -> Iterator[int]:
        """The number of results of each run."""
        for _, part in self._parts():
            yield from self._table(part, RUNS, ("results",))["results"].to_pylist()

    def check_verdicts(self) -> None:
        """Check the violations in `results` against the tables that list them.

        Raises:
            StoreError: the tables contradict each other.
        """
        for _, part in self._parts():
            tables_of_part = {
                name: self._table(part, name, agreement.COLUMNS[name]) for name in TABLES
            }
            try:
                agreement.check(tables_of_part)
            except SchemaError as error:
                raise self._error(f"cannot be read: {error}") from None

    def check_tables(self) -> None:
        """Check each table against the one that the results give, part by part.

        Raises:
            StoreError: a table contradicts the results.
        """
        for _ in self.checked_results():
            pass

    def checked_results(self) -> Iterator[Result]:
        """All results, in order; each part's tables are checked before its results."""
        for start, part in self._parts():
            results = [each for _, each in self.details(range(start, start + part.results))]
            expected = tables.to_tables(results, self.manifest.fretc)
            for name in TABLES:
                stored = self._table(part, name)
                for column in stored.column_names:
                    if not stored[column].equals(expected[name][column]):
                        what = f"`{column}` of `{name}` does not match the results"
                        raise self._error(f"cannot be read: {what}")
            yield from results

    def register(self) -> list[Entry]:
        """The register entry of each log, in the order of the runs; empty: unknown."""
        file = self.manifest.register
        if not file:
            return []
        try:
            data = self._content(REGISTER, file)
            return entries(files.decoded(data, file, types()))
        except SchemaError as error:
            raise self._error(f"cannot be read: {error}") from None

    def _parts(self) -> Iterator[tuple[int, Part]]:
        """Each part with the index of its first result."""
        parts = self.manifest.parts
        starts = accumulate((part.results for part in parts), initial=0)
        return zip(starts, parts, strict=False)

    def _read(
        self, part: Part, name: TableName, read: Callable[[pa.Table], list[T]]
    ) -> Iterator[T]:
        try:
            for group in self._rows(part, name).groups():
                yield from read(group)
        except SchemaError as error:
            raise self._error(f"cannot be read: {error}") from None

    def _table(self, part: Part, name: TableName, columns: Sequence[str] | None = None) -> pa.Table:
        data = self._content(name, part.tables[name])
        try:
            return files.decoded(data, part.tables[name], tables.schema(name), columns)
        except SchemaError as error:
            raise self._error(f"cannot be read: {error}") from None

    def _rows(self, part: Part, name: TableName) -> files.Rows:
        file = part.tables[name]
        return files.Rows(self._content(name, file), file, tables.schema(name))

    def _content(self, name: str, file: TableFile) -> bytes:
        path = Path(self.file, place(name, file))
        try:
            return files.content(path, file)
        except SchemaError as error:
            raise self._error(f"does not fit its manifest: {error}") from None
        except OSError as error:
            why = error.strerror or error
            raise self._error(f"does not fit its manifest: `{path}`: {why}") from None

    def _error(self, what: str) -> StoreError:
        return StoreError(_wrong(self.file, what))


def evidence(store: Store) -> EvidenceFile:
    """The whole store in memory.

    Raises:
        StoreError: the store cannot be read.
    """
    manifest = store.manifest
    results = tuple(store.checked_results())
    document = EvidenceDocument(
        schema=EVIDENCE,
        fretc=manifest.fretc,
        bindings=manifest.bindings,
        requirements=manifest.requirements,
        results=results,
        probabilities=manifest.probabilities,
        selection=manifest.selection,
    )
    return EvidenceFile(store.file, store.sha256, document)


def _wrong(path: str, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_STORE,
        f"the store `{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... -o {path}`",
    )
