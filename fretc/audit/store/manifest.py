"""The manifest of a store: the facts of the audit, and the SHA-256 of each table.

The file name of a table is the beginning of its SHA-256. So no name in a manifest leads elsewhere,
and a new manifest replaces an old one without touching the tables of the old one.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Annotated, Any, Final, Literal

from compiler.files.records import (
    UNSET,
    Count,
    Meta,
    Record,
    Sha256,
    UnsetType,
    about,
    json_schema,
    plain,
)
from compiler.files.templating import to_json
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import BindingsRecord, RequirementRecord, Selection
from fretc.audit.store.tables import TableName

SCHEMA: Final = "fretc-store-1"
FILE = "manifest.json"
UNFINISHED = "unfinished.json"
"""The manifest of an audit that is in progress or was stopped."""
REUSE = {FILE: "reuse.json", UNFINISHED: "unfinished-reuse.json"}
"""Manifest → the file that authenticates it (`fretc.audit.store.register`)."""
REGISTER = "register"
SUFFIX = ".parquet"
_NAME = 32
"""Digits of a SHA-256 that form the name of a file."""


class TableFile(Record, frozen=True):
    """A table file of a store."""

    sha256: Sha256
    size: Annotated[Count, about("bytes")]
    rows: Count


class Part(Record, frozen=True):
    """A part: some consecutive logs."""

    runs: Count
    results: Count
    tables: dict[TableName, TableFile]


class StoreManifest(Record, frozen=True):
    """The manifest of a store."""

    schema: Literal["fretc-store-1"]
    fretc: Annotated[str, about("version of the tool")]
    bindings: BindingsRecord
    requirements: tuple[RequirementRecord, ...]
    confidence: Annotated[
        Annotated[float, Meta(gt=0.5, lt=1)] | None,
        about("over all runs, for a requirement with a probability; null: it is unknown"),
    ]
    parts: Annotated[tuple[Part, ...], about("in the order of the logs")]
    register: Annotated[TableFile | UnsetType, about("how each log was identified")] = UNSET
    probabilities: Annotated[
        Annotated[tuple[Estimated, ...], Meta(min_length=1)] | UnsetType,
        about("what all runs together say of each requirement with a probability"),
    ] = UNSET
    selection: Annotated[
        Selection | UnsetType, about("absent: all logs that were named were audited")
    ] = UNSET


def place(table: str, file: TableFile) -> PurePosixPath:
    """The path of a table in the folder of its store."""
    return PurePosixPath(table, f"{file.sha256[:_NAME]}{SUFFIX}")


def text(manifest: StoreManifest) -> str:
    """The text of the manifest: equal values give equal bytes."""
    return f"{to_json(plain(manifest))}\n"


def schema() -> dict[str, Any]:
    """The JSON Schema of manifests."""
    return json_schema(
        StoreManifest,
        SCHEMA,
        "The manifest of a store of evidence, as `fretc audit` writes it",
        "A table is a file in a folder with the name of the table; the file name is the first "
        "32 digits of its SHA-256.",
    )
