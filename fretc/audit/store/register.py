"""The register of a store: what each of its logs was, so that an unchanged one is known.

Verdicts are taken from a store without reading their logs again. So each run has a mark that only
the user's key can make (`compiler.files.user_key`), for this place, this plan, and the record and
the entry of the run: a store that came with somebody's files is not believed.
"""

from __future__ import annotations

import hmac
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import astuple
from pathlib import Path
from sqlite3 import Connection
from typing import Annotated, Any

from compiler.files.checked_json import SchemaError
from compiler.files.records import Record, Whole, about, decoded_json
from compiler.files.text_files import Stamp, file_sha256, stamp
from fretc.audit.store.container import (
    PackedRun,
    Row,
    check_record,
    check_summary,
    has_summaries,
    packed_run,
    rows,
)
from fretc.audit.store.recordings import KnownBy
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source, Span

_CODES = {code.number: code for code in Code}


class Entry(Record, frozen=True, kw_only=True):
    """The entry of a log. Without a size, the log must be read again."""

    run: str
    log: Annotated[str, about("as named on the command line")]
    place: Annotated[str, about("its path with symbolic links resolved")]
    known_by: Annotated[
        KnownBy,
        about(
            "`read`: this audit read the log; otherwise earlier results or samples were reused, "
            "because its size and times (`stamp`) or its SHA-256 are unchanged"
        ),
    ]
    sha256: Annotated[str, about("empty: the log was not read as a whole, or could not be read")]
    size: Whole | None
    mtime_ns: Whole | None
    ctime_ns: Whole | None
    inode: Whole | None
    settled: Annotated[
        bool | None, about("false: the log had just been written, so its times do not identify it")
    ]
    labels: Annotated[dict[str, str], about("the labels in the log itself")]
    diagnostics: Annotated[tuple[str, ...], about("its diagnostics, as JSON")]

    @property
    def stamp(self) -> Stamp | None:
        """The stamp of the log; None: the log must be read again."""
        parts = (self.size, self.mtime_ns, self.ctime_ns, self.inode)
        size, mtime, ctime, inode = (-1 if part is None else part for part in parts)
        if None in parts:
            return None
        return Stamp(size, mtime, ctime, inode, settled=bool(self.settled))

    def known_by_now(self, *, rehash: bool) -> KnownBy | None:
        """How the log can be identified as unchanged; None: it cannot."""
        before, now = self.stamp, stamp(self.log)
        if before is None or now is None or now.size != before.size:
            return None
        if os.path.realpath(self.log) != self.place:
            return None
        if not rehash and before.settled and now == before:
            return "stamp"
        return "sha256" if self.sha256 and file_sha256(self.log) == self.sha256 else None


def marks(before: Stamp | None) -> dict[str, Any]:
    """The fields of an entry from a stamp."""
    names = ("size", "mtime_ns", "ctime_ns", "inode", "settled")
    return dict(zip(names, astuple(before) if before else (None,) * 5, strict=True))


# Authentication ----------------------------------------------------------------------------------


class StoredPlan(Record, frozen=True):
    """The plan of an audit, as far as a later one must know it to reuse results."""

    plan: Annotated[str, about("the key of the plan")]
    claims: Annotated[dict[str, str], about("the key of each audited requirement")]
    labels: Annotated[dict[str, str], about("the labels that all runs were given")]


@dataclass(frozen=True, slots=True)
class Authenticity:
    """The marks that authenticate the runs of one audit, in one place, for one user."""

    place: str
    """The path of the folder of the store, with symbolic links resolved."""
    plan: str
    """The JSON of the plan."""
    key: bytes

    @classmethod
    def of(cls, folder: Path, plan: str, key: bytes) -> Authenticity:
        """The marks of an audit that writes its store into the folder."""
        return cls(os.path.realpath(folder), plan, key)

    def mark(self, row: Row, entry: str) -> str:
        """What only the user's key can make of a run."""
        hashes = (row.sha256, row.packed_sha256, row.summary_sha256)
        text = json.dumps([self.place, self.plan, row.results, row.size, *hashes, entry])
        return hmac.digest(self.key, text.encode(), "sha256").hex()

    def entries(self, connection: Connection) -> Iterator[tuple[Row, Entry | None]]:
        """Each run with its entry; None: the entry, the record or the summary is not authentic.

        Raises:
            SchemaError: the file is damaged.
        """
        found = connection.execute("SELECT entry, mark FROM runs ORDER BY place")
        for row, (entry, mark) in zip(rows(connection), found, strict=True):
            yield row, self._entry(packed_run(connection, row), f"{entry}", f"{mark}")

    def _entry(self, run: PackedRun, entry: str, mark: str) -> Entry | None:
        if not hmac.compare_digest(mark.encode(), self.mark(run.row, entry).encode()):
            return None
        try:
            check_record(run.row, run.record)
            check_summary(run.row, run.summary)
            return decoded_json(entry.encode(), Entry)
        except SchemaError:
            return None


def is_authentic(connection: Connection, folder: Path, key: bytes) -> bool:
    """Whether a user's key authenticates every run of a store.

    Raises:
        SchemaError: the file is damaged.
    """
    ((plan,),) = connection.execute("SELECT plan FROM about LIMIT 2")
    own = Authenticity.of(folder, f"{plan}", key)
    return has_summaries(connection) and all(entry for _, entry in own.entries(connection))


# Diagnostics -------------------------------------------------------------------------------------


def diagnostic_text(diagnostic: Diagnostic, bindings: Source) -> str:
    """A diagnostic as JSON, without the text of the bindings."""
    span = diagnostic.span
    return json.dumps(
        {
            "code": diagnostic.code.number,
            "message": diagnostic.message,
            "help": diagnostic.help,
            "severity": str(diagnostic.severity),
            "subject": diagnostic.subject,
            "span": span
            and {
                "name": span.source.name,
                "text": None if span.source == bindings else span.source.text,
                "start": span.start,
                "end": span.end,
            },
        }
    )


def diagnostic(text: str, bindings: Source) -> Diagnostic:
    """The diagnostic from its JSON.

    Raises:
        SchemaError: the text is not a diagnostic.
    """
    try:
        plain = json.loads(text)
        return Diagnostic(
            _CODES[plain["code"]],
            plain["message"],
            _place(plain["span"], bindings) if plain["span"] else None,
            plain["help"],
            Severity(plain["severity"]),
            subject=plain["subject"],
        )
    except (ValueError, TypeError, LookupError) as error:
        raise SchemaError(f"a diagnostic cannot be read: {error}") from None


def _place(at: Mapping[str, Any], bindings: Source) -> Span:
    source = bindings if at["text"] is None else Source(at["name"], at["text"])
    return source.span(at["start"], at["end"])
