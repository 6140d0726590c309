"""The register of a store: what each of its logs was, so that an unchanged one is known.

Verdicts are taken from a store without reading their logs again. So a file beside its manifest has
a check that only the user's key can make (`compiler.files.user_key`), for this place, this plan and
the manifest: a store that came with somebody's files is not believed.
"""

from __future__ import annotations

import hmac
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Annotated, Any

import pyarrow as pa

from compiler.files.checked_json import SchemaError
from compiler.files.records import Record, Whole, about, decoded
from compiler.files.text_files import Stamp, file_sha256, stamp
from compiler.files.text_files import read as read_text
from fretc.audit.store.columns import fields_of, objects
from fretc.audit.store.recordings import KnownBy
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


def table(entries: Sequence[Entry]) -> pa.Table:
    """The entries as a table, in the order of the runs."""
    fields = fields_of(Entry)
    arrays = [field.array(entries, exact=False) for field in fields]
    return pa.Table.from_arrays(arrays, names=[field.name for field in fields])


def types() -> pa.Schema:
    """The types of the columns."""
    return pa.schema([pa.field(field.name, field.column.type) for field in fields_of(Entry)])


def entries(found: pa.Table) -> list[Entry]:
    """The entries of a table.

    Raises:
        SchemaError: the table has no valid entries.
    """
    fields = fields_of(Entry)
    arrays = [pa.concat_arrays(found[field.name].chunks) for field in fields] if len(found) else []
    return decoded(objects(fields, arrays), list[Entry]) if arrays else []


# Authentication ----------------------------------------------------------------------------------


def vouched(
    folder: Path,
    plan: str,
    claims: Mapping[str, str],
    labels: Mapping[str, str],
    manifest: str,
    key: bytes,
) -> str:
    """The text of the file that authenticates a store.

    Args:
        folder: the folder of the store.
        plan: the key of the plan of the audit.
        claims: the key of each audited requirement.
        labels: the labels that all runs were given.
        manifest: the SHA-256 of the manifest.
        key: the key of the user.
    """
    content = {
        "plan": plan,
        "claims": dict(claims),
        "labels": dict(labels),
        "manifest": manifest,
    }
    return f"{json.dumps({**content, 'check': _check(folder, content, key)})}\n"


def vouches(folder: Path, name: str, manifest: str, key: bytes) -> Mapping[str, Any] | None:
    """The content of a file that authenticates a store; None: it is not valid for this path."""
    source = read_text(str(folder / name))
    if isinstance(source, Diagnostic):
        return None
    try:
        content = json.loads(source.text)
        check = content.pop("check")
        right = hmac.compare_digest(str(check), _check(folder, content, key))
    except (ValueError, TypeError, AttributeError, KeyError, RecursionError):
        return None
    return content if right and content.get("manifest") == manifest else None


def _check(folder: Path, content: Mapping[str, Any], key: bytes) -> str:
    text = json.dumps({"place": os.path.realpath(folder), **content}, sort_keys=True)
    return hmac.digest(key, text.encode(), "sha256").hex()


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
