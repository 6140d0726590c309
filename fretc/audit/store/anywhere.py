"""Evidence in a JSON file or in a store."""

from __future__ import annotations

import os
from collections import deque
from dataclasses import replace

from compiler.files.user_key import known_user_key
from fretc.audit.evidence import reader as files
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretish.diagnostics.diagnostic import Diagnostic, Severity


def source(
    path: str, *, in_full: bool = False, by_summaries: bool = False
) -> EvidenceSource | Diagnostic:
    """An evidence source that reads a store run by run; a note if it does not exist yet.

    Its methods raise `StoreError` if a store turns out to be invalid.

    Args:
        path: a file, or the folder of a store.
        in_full: check all of each record of a store; otherwise what is read of it.
        by_summaries: count by the summaries of a store that the user's key authenticates, without
            a look into its records.
    """
    if not os.path.isdir(path):
        return files.read(path)
    from fretc.audit.store.container import StoreError
    from fretc.audit.store.reader import Store, opened

    store = opened(path, known_user_key() if by_summaries else None)
    try:
        if in_full and isinstance(store, Store):
            deque(store.results(), maxlen=0)
    except StoreError as error:
        return error.diagnostic
    return store


def read(path: str) -> EvidenceFile | Diagnostic:
    """Read and check evidence; a note, not an error, if it does not exist yet.

    Args:
        path: a file, or the folder of a store, which is read into memory as a whole.
    """
    if not os.path.isdir(path):
        return files.read(path)
    from fretc.audit.store.container import StoreError
    from fretc.audit.store.reader import Store, evidence, opened

    store = opened(path)
    try:
        return evidence(store) if isinstance(store, Store) else store
    except StoreError as error:
        return error.diagnostic


def required_source(
    path: str, *, in_full: bool = False, by_summaries: bool = False
) -> EvidenceSource | Diagnostic:
    """An evidence source; an error if the evidence does not exist."""
    found = source(path, in_full=in_full, by_summaries=by_summaries)
    return replace(found, severity=Severity.ERROR) if isinstance(found, Diagnostic) else found


def required(path: str) -> EvidenceFile | Diagnostic:
    """The evidence, or an error if it does not exist."""
    result = read(path)
    return replace(result, severity=Severity.ERROR) if isinstance(result, Diagnostic) else result
