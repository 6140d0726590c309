"""A store as it is written: part by part, each file complete or absent, the manifest last."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from compiler.files.text_files import sha256, write
from fretc.audit.evidence.schema import Document, Result
from fretc.audit.store.files import encoded
from fretc.audit.store.manifest import FILE, SCHEMA, SUFFIX, Manifest, Part, place, text
from fretc.audit.store.parts import parts
from fretc.audit.store.tables import RESULTS, RUNS, TABLES, runs_of, tabled
from fretish.diagnostics.diagnostic import Diagnostic


def write_part(folder: Path, results: Sequence[Result], fretc: str) -> Part | Diagnostic:
    """Write the tables of some runs.

    Args:
        folder: of the store.
        results: of whole runs.
        fretc: the version that made them.

    Returns:
        What the manifest says of them; or why they cannot be written.
    """
    files = {name: encoded(table) for name, table in tabled(results, fretc).items()}
    wrong = write({folder / place(name, file): data for name, (data, file) in files.items()})
    if wrong is not None:
        return wrong
    tables = {name: file for name, (_, file) in files.items()}
    return Part(tables[RUNS].rows, tables[RESULTS].rows, tables)


def finish(folder: Path, manifest: Manifest) -> str | Diagnostic:
    """Write the manifest, and remove what belonged to an earlier one.

    Returns:
        Its SHA-256; or why it cannot be written.
    """
    content = text(manifest)
    wrong = write({folder / FILE: content})
    if wrong is not None:
        return wrong
    remove_others(folder, manifest)
    return sha256(content)


def remove_others(folder: Path, manifest: Manifest | None) -> None:
    """Remove tables that a manifest does not name; None: all of them."""
    kept = {folder / path for path in _files(manifest)} if manifest else set()
    for table in TABLES:
        for path in [*(folder / table).glob(f"*{SUFFIX}"), *(folder / table).glob(".*.tmp")]:
            if path not in kept:
                path.unlink(missing_ok=True)
        with suppress(OSError):  # something else is there
            (folder / table).rmdir()


def _files(manifest: Manifest) -> Iterable[Path]:
    for part in manifest.parts:
        for name, file in part.tables.items():
            yield Path(place(name, file))


def write_document(
    folder: Path, document: Document, confidence: float | None = None
) -> str | Diagnostic:
    """Write evidence that is in memory as a store; gives the SHA-256 of its manifest."""
    runs = runs_of(document.results)
    written: list[Part] = []
    for places in parts([run[0].run for run in runs]):
        results = [result for place in places for result in runs[place]]
        part = write_part(folder, results, document.fretc)
        if isinstance(part, Diagnostic):
            return part
        written.append(part)
    manifest = Manifest(
        schema=SCHEMA,
        fretc=document.fretc,
        bindings=document.bindings,
        requirements=document.requirements,
        confidence=confidence,
        parts=tuple(written),
        probabilities=document.probabilities,
    )
    return finish(folder, manifest)
