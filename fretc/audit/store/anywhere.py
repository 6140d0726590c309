"""Evidence wherever it is: in a JSON file or in a store."""

from __future__ import annotations

import os
from dataclasses import replace

from fretc.audit.evidence import reader as files
from fretc.audit.evidence.briefs import EvidenceSource
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.store.errors import StoreError
from fretish.diagnostics.diagnostic import Diagnostic, Severity


def read(path: str) -> EvidenceFile | Diagnostic:
    """Read and check evidence; a note, not an error, where there is none yet.

    Args:
        path: a file, or the folder of a store: that is read into memory as a whole.
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
    """Evidence to read from, of a store little at a time; a note where there is none yet.

    Its methods raise `StoreError` where a store turns out not to be what it must be.

    Args:
        path: a file, or the folder of a store.
        in_full: hold each table of a store against its results; else the verdicts alone.
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
    """The same; an error where there is none."""
    found = source(path, in_full=in_full)
    return replace(found, severity=Severity.ERROR) if isinstance(found, Diagnostic) else found


def required(path: str) -> EvidenceFile | Diagnostic:
    """The same; an error where there is none."""
    evidence = read(path)
    if isinstance(evidence, Diagnostic):
        return replace(evidence, severity=Severity.ERROR)
    return evidence
