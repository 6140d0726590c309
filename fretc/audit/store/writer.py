"""The writer of a store: part by part, each file complete or absent, the manifest last."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from compiler.files.checked_json import SchemaError
from compiler.files.text_files import open_regular, sha256, write
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.audit.store import register
from fretc.audit.store.files import content, encoded
from fretc.audit.store.manifest import (
    FILE,
    REGISTER,
    REUSE,
    SCHEMA,
    UNFINISHED,
    Part,
    StoreManifest,
    TableFile,
    place,
    text,
)
from fretc.audit.store.parts import parts
from fretc.audit.store.register import Entry
from fretc.audit.store.tables import RESULTS, RUNS, TABLES, Tables, runs_of, to_tables
from fretish.diagnostics.diagnostic import Diagnostic


def write_part(folder: Path, tables: Tables) -> Part | Diagnostic:
    """Write the tables of some runs.

    Args:
        folder: the folder of the store.
        tables: the tables of whole runs.

    Returns:
        What the manifest says of them; or why they cannot be written.
    """
    encoded_tables = {name: encoded(table) for name, table in tables.items()}
    wrong = write(
        {
            folder / place(name, file): data
            for name, (data, file) in encoded_tables.items()
            if not _is_there(folder / place(name, file), file)
        }
    )
    if wrong is not None:
        return wrong
    files_of_tables = {name: file for name, (_, file) in encoded_tables.items()}
    return Part(files_of_tables[RUNS].rows, files_of_tables[RESULTS].rows, files_of_tables)


def _is_there(path: Path, file: TableFile) -> bool:
    try:
        content(path, file)
    except (OSError, SchemaError):
        return False
    return True


def write_register(folder: Path, entries: Sequence[Entry]) -> TableFile | Diagnostic:
    """Write the register of the logs."""
    data, file = encoded(register.table(entries))
    return write({folder / place(REGISTER, file): data}) or file


def write_manifest(folder: Path, manifest: StoreManifest, name: str = FILE) -> str | Diagnostic:
    """Write a manifest; gives its SHA-256."""
    content = text(manifest)
    return write({folder / name: content}) or sha256(content)


def files(folder: Path) -> set[Path]:
    """All table files in a folder, also those that no manifest lists."""
    own = (folder / table for table in (*TABLES, REGISTER) if not (folder / table).is_symlink())
    paths = (path for table in own for path in table.glob("*"))
    return {path for path in paths if _OURS.fullmatch(path.name)}


def remove_others(
    folder: Path, *manifests: StoreManifest, kept: Collection[Path] = frozenset()
) -> None:
    """Remove the tables that none of the manifests lists.

    Args:
        folder: the folder of the store.
        manifests: the manifests whose tables stay.
        kept: other files that stay.
    """
    named = {folder / path for manifest in manifests for path in _files(manifest)}
    for path in files(folder) - named - {*kept}:
        path.unlink(missing_ok=True)
    for table in (*TABLES, REGISTER):
        with suppress(OSError):  # the folder is in use, or not empty
            (folder / table).rmdir()


_OURS = re.compile(r"[0-9a-f]{32}\.parquet|\.[0-9a-f]{32}\.parquet\.[0-9a-f]{8}\.tmp")


def _files(manifest: StoreManifest) -> Iterator[Path]:
    for part in manifest.parts:
        for name, file in part.tables.items():
            yield Path(place(name, file))
    if manifest.register:
        yield Path(place(REGISTER, manifest.register))


def is_store(folder: Path) -> bool:
    """Whether fretc has written into a folder, which is a condition for removing files from it."""
    if any((folder / table).is_symlink() for table in (*TABLES, REGISTER)):
        return False  # a link leads out of this folder
    return any(_is_manifest(folder / name) for name in (FILE, UNFINISHED))


def _is_manifest(path: Path) -> bool:
    try:
        with open_regular(path) as file:
            return SCHEMA.encode() in file.read(200)
    except OSError:
        return False


def remove(folder: Path) -> None:
    """Remove a store, and its folder if it is empty then."""
    for name in (FILE, UNFINISHED, *REUSE.values()):
        (folder / name).unlink(missing_ok=True)
    remove_others(folder)
    with suppress(OSError):
        folder.rmdir()


def write_document(
    folder: Path, document: EvidenceDocument, confidence: float | None = None
) -> str | Diagnostic:
    """Write evidence that is in memory as a store; gives the SHA-256 of its manifest."""
    runs = runs_of(document.results)
    written: list[Part] = []
    for places in parts([run[0].run for run in runs]):
        results = [result for place in places for result in runs[place]]
        part = write_part(folder, to_tables(results, document.fretc))
        if isinstance(part, Diagnostic):
            return part
        written.append(part)
    manifest = StoreManifest(
        schema=SCHEMA,
        fretc=document.fretc,
        bindings=document.bindings,
        requirements=document.requirements,
        confidence=confidence,
        parts=tuple(written),
        probabilities=document.probabilities,
        selection=document.selection,
    )
    digest = write_manifest(folder, manifest)
    if isinstance(digest, str):
        remove_others(folder, manifest)
    return digest
