"""The container of a store: one SQLite file with a row for each run.

A row has the results of a run as JSON, compressed with zstd: the objects of an evidence file, with
what they share in one place. Beside it is a summary that is made from them
(`fretc.audit.store.run_summaries`). The identity of the evidence is the SHA-256 of its head and its
records, whatever the file looks like.
"""

from __future__ import annotations

import hashlib
import os
import re
import sqlite3
import stat
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Annotated, Any, Generic, NamedTuple, TypeVar

import zstandard

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import (
    UNSET,
    Count,
    Meta,
    Raw,
    Record,
    Sha256,
    UnsetType,
    decoded,
    decoded_json,
    json_bytes,
    plain,
)
from fretc.audit.evidence.schema import Result
from fretc.audit.store.run_summaries import run_summary
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.system.files import NO_LINK, NO_WAIT, TO_READ

T = TypeVar("T")
FILE = "evidence.sqlite"
"""The file in the folder of a store."""
_UNFINISHED = re.compile(r"unfinished-([1-9]\d{0,8})\.sqlite")
"""A file of an audit that is in progress or was stopped; a later one has a greater number."""
LARGEST = 2**30
"""The most bytes of the results of a run, as JSON."""
_LEVEL = 9
_APPLICATION = 0x66726574
_ABOUT = "CREATE TABLE about (head TEXT, sha256 TEXT, plan TEXT)"
_TABLES = (
    _ABOUT,
    "CREATE TABLE runs (place INTEGER PRIMARY KEY, results INTEGER, size INTEGER, sha256 TEXT, "
    "packed_sha256 TEXT, summary_sha256 TEXT, entry TEXT, mark TEXT, summary BLOB, record BLOB)",
)
"""`about` has one row; its head is an evidence file without results. `place` is the position of a
run, `size` the number of bytes of its JSON."""
_TABLES_WITHOUT_SUMMARIES = (
    _ABOUT,
    "CREATE TABLE runs (place INTEGER PRIMARY KEY, results INTEGER, size INTEGER, sha256 TEXT, "
    "packed_sha256 TEXT, entry TEXT, mark TEXT, record BLOB)",
)
"""The tables of an earlier version, which are only read."""
_LAYOUTS = [[(table,) for table in layout] for layout in (_TABLES, _TABLES_WITHOUT_SUMMARIES)]


class StoreError(Exception):
    """A store is invalid."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic


class RunRecord(Record, Generic[T], frozen=True):
    """The record of a run: its results, without what they share."""

    run: str
    health: Raw
    results: list[T]
    labels: Raw | UnsetType = UNSET


_SHARED = ("run", "health", "labels")
"""The fields that the results of a run share."""


def record_text(results: Sequence[Result]) -> bytes:
    """The JSON of the record of a run: equal results give equal bytes.

    Args:
        results: the results of one run, at least one.
    """
    whole = [plain(each) for each in results]
    shared = {name: whole[0][name] for name in _SHARED if name in whole[0]}
    own = [{name: each[name] for name in each if name not in _SHARED} for each in whole]
    return json_bytes({**shared, "results": own})


def whole_results(record: RunRecord[Raw], indices: Iterable[int]) -> Iterator[Result]:
    """Results of a run, checked as in an evidence file.

    Args:
        record: the record of the run.
        indices: those of the results in the run.

    Raises:
        SchemaError: a result is not strict JSON, or not a result.
    """
    shared = {"run": record.run, "health": strict(record.health, object)}
    if record.labels is not UNSET:
        shared["labels"] = strict(record.labels, object)
    for index in indices:
        own = strict(record.results[index], dict[str, Any])
        if not own.keys().isdisjoint(_SHARED):
            raise SchemaError("a result has a fact of its run")
        yield decoded({**own, **shared}, Result)


def strict(raw: Raw, kind: type[T]) -> T:
    """A part of a record, checked as in an evidence file.

    Raises:
        SchemaError: it is not strict JSON, or does not fit its type.
    """
    try:
        text = bytes(raw).decode()
    except UnicodeDecodeError:
        raise SchemaError("a text is not UTF-8") from None
    return decoded(parsed(text), kind)


class Row(Record, frozen=True):
    """What a store says of the record of a run."""

    place: Count
    results: Annotated[int, Meta(ge=1, le=LARGEST)]
    size: Annotated[int, Meta(ge=0, le=LARGEST)]
    sha256: Sha256
    packed_sha256: Sha256
    summary_sha256: Sha256 | None = None
    """Of the packed summary; None: an earlier version wrote the store, without summaries."""


class PackedRun(NamedTuple):
    """A run as a store holds it."""

    row: Row
    record: bytes
    summary: bytes


def identity(head: str, rows: Sequence[Row]) -> str:
    """The SHA-256 of the evidence: of its head and its runs, in order."""
    lines = (head, *(row.sha256 for row in rows))
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def packed(place: int, results: Sequence[Result]) -> PackedRun:
    """The record of a run, and its summary."""
    data = record_text(results)
    record = zstandard.ZstdCompressor(level=_LEVEL).compress(data)
    summary = zstandard.compress(run_summary(results).text)
    hashes = (hashlib.sha256(each).hexdigest() for each in (data, record, summary))
    return PackedRun(Row(place, len(results), len(data), *hashes), record, summary)


def check_record(row: Row, record: bytes) -> None:
    """Compare the bytes of a record with its hash.

    Raises:
        SchemaError: they are others.
    """
    if hashlib.sha256(record).hexdigest() != row.packed_sha256:
        raise SchemaError("a record is not the one that was written")


def check_summary(row: Row, summary: bytes) -> None:
    """Compare the bytes of a packed summary with its hash.

    Raises:
        SchemaError: they are others.
    """
    if hashlib.sha256(summary).hexdigest() != row.summary_sha256:
        raise SchemaError("a summary is not the one that was written")


def unpacked(row: Row, record: bytes, kind: type[T], *, known: bool = False) -> RunRecord[T]:
    """The record of a run.

    Args:
        row: the row of the run.
        record: its record, which nobody has checked.
        kind: what is decoded of each result.
        known: whether both hashes of the row are known to be of the same record; then only that of
            the packed record is compared, which has a tenth of the size.

    Raises:
        SchemaError: the record is damaged, or other than its row says.
    """
    check_record(row, record)
    data = _unpacked(record, "a record", row.size)
    if not known and hashlib.sha256(data).hexdigest() != row.sha256:
        raise SchemaError("a record is not the one that its row says")
    found = decoded_json(data, RunRecord[kind])  # type: ignore[valid-type]
    if len(found.results) != row.results:
        raise SchemaError("a run does not have the results that its row says")
    return found


def unpacked_summary(row: Row, summary: bytes) -> bytes:
    """The JSON of the summary of a run.

    Args:
        row: the row of the run.
        summary: its packed summary, which nobody has checked.

    Raises:
        SchemaError: the summary is damaged.
    """
    check_summary(row, summary)
    return _unpacked(summary, "a summary")


class _Zstd(threading.local):
    """The decompressor of a thread: another one for each record takes as long as a small record."""

    def __init__(self) -> None:
        self.decompressor = zstandard.ZstdDecompressor()


_ZSTD = _Zstd()


def _unpacked(data: bytes, what: str, size: int | None = None) -> bytes:
    """What was compressed; a size is compared before memory is used."""
    try:
        known = zstandard.frame_content_size(data)
        if size not in (None, known) or not 0 <= known <= LARGEST:
            raise SchemaError(f"{what} does not have the size that its row says")
        return _ZSTD.decompressor.decompress(data)
    except zstandard.ZstdError as error:
        raise SchemaError(f"{what} cannot be unpacked: {error}") from None


# Files -------------------------------------------------------------------------------------------


def unfinished(folder: Path) -> list[Path]:
    """The files of audits that are in progress or were stopped, in order."""
    return [_unfinished(folder, number) for number in _numbers(folder)]


def next_unfinished(folder: Path) -> Path:
    """The path for the file of a new audit."""
    return _unfinished(folder, max(_numbers(folder), default=0) + 1)


def _unfinished(folder: Path, number: int) -> Path:
    return folder / f"unfinished-{number}.sqlite"


def _numbers(folder: Path) -> list[int]:
    names = os.listdir(folder) if folder.is_dir() else ()
    return sorted(int(match[1]) for match in map(_UNFINISHED.fullmatch, names) if match)


def written(path: Path, *, new: bool = False) -> sqlite3.Connection:
    """A file to write to, which is whole whenever the process is killed.

    Args:
        path: where it is.
        new: make it, with empty tables; what is there is removed.
    """
    if new:
        remove_file(path)
    connection = sqlite3.connect(path, isolation_level=None)
    for pragma in ("trusted_schema=OFF", "locking_mode=EXCLUSIVE"):  # no memory is shared
        connection.execute(f"PRAGMA {pragma}")
    if new:
        connection.execute(f"PRAGMA application_id={_APPLICATION}")
        for table in _TABLES:
            connection.execute(table)
        connection.execute("INSERT INTO about VALUES (NULL, NULL, NULL)")
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL"):
        connection.execute(f"PRAGMA {pragma}")
    return connection


def remove_file(path: Path) -> None:
    """Remove a file with those that SQLite keeps beside it."""
    remove_beside(path, "", "-wal", "-shm", "-journal")


def remove_beside(path: Path, *suffixes: str) -> None:
    """Remove the files of which the names begin with that of a file."""
    for suffix in suffixes:
        path.with_name(path.name + suffix).unlink(missing_ok=True)


def closed(connection: sqlite3.Connection) -> None:
    """Close a file so that it stands alone, without a file of its last transactions."""
    with closing(connection):
        connection.execute("PRAGMA journal_mode=DELETE")


def recovered(path: Path) -> bool:
    """Make a file stand alone whose process was killed; false: it is damaged, or no such file.

    A rollback journal, which fretc does not write, is removed: SQLite would remove what it names.
    So is a link, which SQLite would follow.
    """
    beside = path.with_name(f"{path.name}-wal")
    remove_beside(path, "-journal", "-shm", *(("-wal",) if beside.is_symlink() else ()))
    if not is_container(path):
        return False
    try:
        closed(written(path))
    except sqlite3.Error:
        return False
    return True


def is_container(path: Path) -> bool:
    """Whether a path is a regular file that fretc has written."""
    try:
        descriptor = os.open(path, TO_READ | NO_LINK | NO_WAIT)
        with open(descriptor, "rb") as file:
            start = file.read(72) if stat.S_ISREG(os.fstat(descriptor).st_mode) else b""
    except OSError:
        return False
    return start[:16] == b"SQLite format 3\0" and start[68:] == _APPLICATION.to_bytes(4, "big")


@contextmanager
def opened(path: Path) -> Iterator[sqlite3.Connection]:
    """An untrusted file, which is only read and has the tables of a store.

    Raises:
        SchemaError: it is no such file, or SQLite cannot read it.
    """
    if not is_container(path):
        raise SchemaError("it is not a file that fretc has written")
    address = f"{path.absolute().as_uri()}?mode=ro&immutable=1"
    try:
        with closing(sqlite3.connect(address, uri=True, isolation_level=None)) as connection:
            connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST)
            connection.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)
            for pragma in ("trusted_schema=OFF", "cell_size_check=ON", "query_only=ON"):
                connection.execute(f"PRAGMA {pragma}")
            tables = connection.execute("SELECT sql FROM sqlite_master LIMIT 9").fetchall()
            if tables not in _LAYOUTS:
                raise SchemaError("it does not have the tables of this version of fretc")
            yield connection
    except sqlite3.Error as error:
        raise SchemaError(f"it is damaged: {error}") from None


def has_summaries(connection: sqlite3.Connection) -> bool:
    """Whether a store has summaries; one of an earlier version has none."""
    columns = connection.execute("SELECT * FROM runs LIMIT 0").description
    return any(name == "summary" for name, *_ in columns)


def rows(connection: sqlite3.Connection) -> list[Row]:
    """The row of each run, in order.

    Raises:
        SchemaError: a row is invalid.
    """
    without = () if has_summaries(connection) else ("summary_sha256",)
    names = [name for name in Row.__struct_fields__ if name not in without]
    found: list[Row] = []
    for values in connection.execute(f"SELECT {', '.join(names)} FROM runs ORDER BY place"):
        row = decoded(dict(zip(names, values, strict=True)), Row)
        if found and row.place <= found[-1].place:
            raise SchemaError("its runs are in no order")
        found.append(row)
    return found


def record_of(connection: sqlite3.Connection, place: int) -> bytes:
    """The packed record of a run.

    Raises:
        SchemaError: there is none.
    """
    return _bytes(connection, "record", place)


def summary_of(connection: sqlite3.Connection, place: int) -> bytes:
    """The packed summary of a run, in a store that has summaries.

    Raises:
        SchemaError: there is none.
    """
    return _bytes(connection, "summary", place)


def packed_run(connection: sqlite3.Connection, row: Row) -> PackedRun:
    """A run as the store holds it, in a store that has summaries.

    Raises:
        SchemaError: its record or its summary is missing.
    """
    return PackedRun(row, record_of(connection, row.place), summary_of(connection, row.place))


def _bytes(connection: sqlite3.Connection, column: str, place: int) -> bytes:
    found = connection.execute(f"SELECT {column} FROM runs WHERE place = ?", (place,)).fetchone()
    if found is None or not isinstance(found[0], bytes):
        raise SchemaError(f"a {column} is missing")
    data: bytes = found[0]
    return data


def bad_store(path: str, what: str) -> Diagnostic:
    """F516."""
    return Diagnostic(
        Code.BAD_STORE,
        f"the store `{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... -o {path}`",
    )
