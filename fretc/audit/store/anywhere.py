"""Evidence in a JSON file or in a store."""

from __future__ import annotations

import os
from dataclasses import replace

from fretc.audit.evidence import reader as files
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.store.errors import StoreError
from fretish.diagnostics.diagnostic import Diagnostic, Severity


def read(path: str) -> EvidenceFile | Diagnostic:
    """Read and check evidence; a note, not an error, if it does not exist yet.

    Args:
        path: a file, or the folder of a store, which is read into memory as a whole.
    """
    if not os.path.isdir(path):
        return files.read(path)
    from fretc.audit.store.reader import evidence, opened

    store = opened(path)
    if isinstance(store, Diagnostic):
        return store
    try:
        return evidence(store)
    except StoreError as error:
        return error.diagnostic


def source(path: str, *, in_full: bool = False) -> EvidenceSource | Diagnostic:
    """An evidence source that reads a store piece by piece; a note if it does not exist yet.

    Its methods raise `StoreError` if a store turns out to be invalid.

    Args:
        path: a file, or the folder of a store.
        in_full: check each table of a store against its results; otherwise only the verdicts.
    """
    if not os.path.isdir(path):
        return files.read(path)
    from fretc.audit.store.reader import opened

    store = opened(path)
    if isinstance(store, Diagnostic):
        return store
    try:
        store.check_tables() if in_full else store.check_verdicts()
    except StoreError as error:
        return error.diagnostic
    return store


def required_source(path: str, *, in_full: bool = False) -> EvidenceSource | Diagnostic:
    """An evidence source; an error if the evidence does not exist."""
    evidence = source(path, in_full=in_full)
    return (
        replace(evidence, severity=Severity.ERROR) if isinstance(evidence, Diagnostic) else evidence
    )


def required(path: str) -> EvidenceFile | Diagnostic:
    """The evidence, or an error if it does not exist."""
    evidence = read(path)
    if isinstance(evidence, Diagnostic):
        return replace(evidence, severity=Severity.ERROR)
    return evidence
