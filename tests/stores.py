"""A store made of evidence that is in memory."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from compiler.files.records import UNSET
from fretc.audit.evidence.schema import EvidenceDocument, Result
from fretc.audit.store import earlier_store
from fretc.audit.store.container import next_unfinished, packed
from fretc.audit.store.writer import StoreFile, complete, publish


def write_document(folder: Path, document: EvidenceDocument) -> str:
    """Write the evidence; gives its SHA-256."""
    folder.mkdir(parents=True, exist_ok=True)
    file = StoreFile(next_unfinished(folder))
    file.connection.execute("BEGIN")
    for place, run in enumerate(runs_of(document.results)):
        file.put(packed(place, run))
    file.connection.execute("COMMIT")
    sha256 = complete(file.path, document, file.close())
    publish(file.path)
    earlier_store.remove_tables(folder)
    return sha256


def runs_of(results: Iterable[Result]) -> list[list[Result]]:
    """The results of each run: adjoining results that share the facts of a run.

    A result with plot data is the first of its run.
    """
    runs: list[list[Result]] = []
    ids: set[str] = set()
    for result in results:
        is_first = not runs or result.requirement in ids or result.course is not UNSET
        if is_first or _shared(result) != _shared(runs[-1][0]):
            runs.append([])
            ids = set()
        runs[-1].append(result)
        ids.add(result.requirement)
    return runs


def _shared(result: Result) -> tuple[object, ...]:
    return result.run, result.health, result.labels
