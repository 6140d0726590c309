"""The writer of a store: run by run, and the file gets its name when it is complete."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from compiler.files.records import replace
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.audit.evidence.writer import text
from fretc.audit.store import earlier_store
from fretc.audit.store.container import (
    FILE,
    PackedRun,
    Row,
    closed,
    identity,
    is_container,
    remove_file,
    rows,
    unfinished,
    written,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.system.files import replace as rename

_COLUMNS = (*Row.__struct_fields__, "entry", "mark", "summary", "record")
_INSERT = f"INSERT INTO runs ({', '.join(_COLUMNS)}) VALUES ({', '.join('?' * len(_COLUMNS))})"


class StoreFile:
    """A file of a store that is being written; whatever ends the process, its runs stay."""

    def __init__(self, path: Path, plan: str | None = None) -> None:
        """Make the file.

        Args:
            path: where it is written.
            plan: what a later audit must know to reuse the results.

        Raises:
            SqliteError: the file cannot be written.
        """
        self.path, self.runs = path, 0
        self.connection = written(path, new=True)
        self.connection.execute("UPDATE about SET plan = ?", (plan,))
        self.is_open = True

    def put(self, run: PackedRun, entry: str | None = None, mark: str | None = None) -> None:
        """Write a run.

        Args:
            run: its row, its record and its summary.
            entry: its entry in the register, as JSON.
            mark: what authenticates both (`fretc.audit.store.register`).
        """
        own = (getattr(run.row, name) for name in Row.__struct_fields__)
        self.connection.execute(_INSERT, (*own, entry, mark, run.summary, run.record))
        self.runs += 1

    def reusable(self) -> int:
        """The number of runs that a later audit can reuse."""
        entries = self.connection.execute("SELECT entry FROM runs WHERE mark IS NOT NULL")
        return sum(json.loads(entry)["size"] is not None for (entry,) in entries)

    def close(self) -> list[Row]:
        """Close the file; gives the row of each run."""
        found = rows(self.connection)
        self.discard()
        return found

    def discard(self) -> None:
        """Close the file if it is open."""
        if self.is_open:
            self.is_open = False
            closed(self.connection)


def complete(path: Path, document: EvidenceDocument, found: Sequence[Row]) -> str:
    """Write the head of a file that was closed; gives the SHA-256 of the evidence.

    Args:
        path: of the file.
        document: the evidence; its results are not written.
        found: the row of each run.
    """
    head = text(replace(document, results=()))
    sha256 = identity(head, found)
    connection = written(path)
    try:
        connection.execute("UPDATE about SET head = ?, sha256 = ?", (head, sha256))
    finally:
        closed(connection)
    return sha256


def publish(path: Path) -> Path:
    """Give a complete file its name in one step; gives its new path."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
    named = path.with_name(FILE)
    rename(path, named)
    return named


def is_store(folder: Path) -> bool:
    """Whether fretc has written into a folder, which is a condition for removing files from it."""
    own = any(is_container(path) for path in (folder / FILE, *unfinished(folder)))
    return own or earlier_store.is_store(folder)


def remove(folder: Path) -> None:
    """Remove a store, and its folder if it is empty then."""
    for path in (folder / FILE, *unfinished(folder)):
        remove_file(path)
    earlier_store.remove_tables(folder)
    with suppress(OSError):
        folder.rmdir()


def not_written(folder: Path, error: Exception) -> Diagnostic:
    """F905."""
    why = error.strerror if isinstance(error, OSError) else None
    return Diagnostic(
        Code.NOT_WRITTEN,
        f"`{folder / FILE}` cannot be written: {why or error}",
        help="write to another path, or fix this one",
    )
