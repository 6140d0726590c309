"""`waivers.toml`: requirements that may pass without being shown, with reason, person and expiry.

The report shows the verdict that a waiver covers. A waiver expires by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from datetime import date
from typing import Any

from compiler.files.dates import is_date
from compiler.files.text_files import read as read_text
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN
from fretc.audit.measurements.confidence_intervals import REFUTED
from fretish.bindings.canonical import digest
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import Tables, unknown_key
from fretish.reading.toml_text import read as read_tables
from monitors import kernel

NAME = "waivers.toml"
FIELDS = ("verdict", "reason", "by", "role", "granted", "expires")
UNFORMALIZED, NOT_EXERCISED = "unformalized", "not exercised"
VERDICTS = (
    kernel.VIOLATED,
    REFUTED,
    ASSUMPTION_BROKEN,
    UNFORMALIZED,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    NOT_EXERCISED,
)
"""The verdicts that a waiver may cover: those that do not show a requirement. `suspect` is none of
them, because the person waived an earlier state."""


@dataclass(frozen=True, slots=True)
class Waiver:
    """The waiver of one verdict of one requirement, until a date."""

    requirement: str
    verdict: str
    """The waived verdict: one of `VERDICTS`."""
    reason: str
    by: str
    role: str
    granted: str
    expires: str
    """The last day on which the waiver is valid; dates are written as `2026-11-22`."""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def seal(self) -> str:
        """SHA-256 of the whole waiver, which a signature covers."""
        return digest([self.requirement, *(getattr(self, name) for name in FIELDS)])

    def covers(self, day: str) -> bool:
        """Whether the waiver is valid on that day."""
        return self.granted <= day <= self.expires


def read(
    path: str, ids: Sequence[str] | None, day: str
) -> tuple[Mapping[str, Waiver], tuple[Diagnostic, ...]]:
    """The waivers of a file, and diagnostics about them.

    Args:
        path: the file.
        ids: the ids of the requirements; None: any may be waived.
        day: a warning is returned for each waiver that is not valid on that day.
    """
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return {}, (source,)
    tables = read_tables(source.span(), Code.BAD_WAIVER, "the waivers file")
    if isinstance(tables, Diagnostic):
        return {}, (tables,)
    wrong = tuple(
        d for id, fields in tables.data.items() for d in _mistakes(tables, id, fields, ids)
    )
    if wrong:
        return {}, wrong
    waivers = {
        id: Waiver(id, **fields, span=tables.value(id, "verdict"))
        for id, fields in tables.data.items()
    }
    return waivers, tuple(
        _ended(tables, waiver) for waiver in waivers.values() if not waiver.covers(day)
    )


def _mistakes(
    tables: Tables, id: str, fields: Any, ids: Sequence[str] | None
) -> Iterator[Diagnostic]:
    if not isinstance(fields, dict):
        yield _wrong(tables, f"`{id}` is not a waiver", f"write `[{id}]`, then its fields", id)
        return
    if ids is not None and id not in ids:
        fix = did_you_mean(id, ids, "name a requirement of the project")
        yield _wrong(tables, f"{id} is waived, but is not among the requirements", fix, id)
    for key in fields:
        if key not in FIELDS:
            yield unknown_key(Code.BAD_WAIVER, key, FIELDS, tables.place(id, key), f"[{id}]")
    for name in FIELDS:
        value = fields.get(name)
        if name == "verdict" and value not in VERDICTS:
            yield _no_verdict(tables, id, value)
        elif not isinstance(value, str) or not value.strip():
            yield _wrong(
                tables, f"the waiver of {id} has no `{name}`", f'add `{name} = "..."`', id, name
            )
        elif name in ("granted", "expires") and not is_date(value):
            fix = f'write it as `"{date(2026, 11, 22).isoformat()}"`'
            yield _wrong(tables, f"`{value}` is not a date", fix, id, name)


def _no_verdict(tables: Tables, id: str, value: object) -> Diagnostic:
    """The diagnostic for a missing or unknown verdict."""
    listed = ", ".join(f"`{word}`" for word in VERDICTS)
    if value is None:
        what, fix = (
            f"the waiver of {id} does not name the verdict that it covers",
            'add `verdict = "',
        )
        return _wrong(tables, what, f'{fix}no data"`; it may be {listed}', id, "reason")
    fix = did_you_mean(str(value), VERDICTS, f"it may be {listed}")
    return _wrong(tables, f"`{value}` is not a verdict that can be waived", fix, id, "verdict")


def _wrong(tables: Tables, what: str, fix: str, *path: str) -> Diagnostic:
    return Diagnostic(Code.BAD_WAIVER, what, tables.value(*path), help=fix)


def _ended(tables: Tables, waiver: Waiver) -> Diagnostic:
    return diagnostic(
        "expired_waiver",
        tables.value(waiver.requirement, "expires"),
        requirement=waiver.requirement,
        granted=waiver.granted,
        expires=waiver.expires,
    )
