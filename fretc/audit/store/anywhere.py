"""Evidence wherever it is: in a JSON file or in a store."""

from __future__ import annotations

import os
from dataclasses import replace

from fretc.audit.evidence import reader as files
from fretc.audit.evidence.schema import Evidence
from fretc.audit.measurements.confidence_intervals import REFUTED
from fretish.diagnostics.diagnostic import Diagnostic, Severity


def read(path: str) -> Evidence | Diagnostic:
    """Read and check evidence; a note, not an error, where there is none yet.

    Args:
        path: a file, or the folder of a store: that is read into memory as a whole.
    """
    if not os.path.isdir(path):
        return files.read(path)
    from fretc.audit.store.reader import StoreError, evidence, opened

    store = opened(path)
    if isinstance(store, Diagnostic):
        return store
    try:
        return evidence(store)
    except StoreError as error:
        return error.diagnostic


def required(path: str) -> Evidence | Diagnostic:
    """The same; an error where there is none."""
    evidence = read(path)
    if isinstance(evidence, Diagnostic):
        return replace(evidence, severity=Severity.ERROR)
    return evidence


def refuted(path: str) -> frozenset[str]:
    """The requirements that all runs together refute; none where there is no evidence."""
    evidence = read(path)
    estimates = () if isinstance(evidence, Diagnostic) else evidence.probabilities
    return frozenset(one.requirement for one in estimates if one.answer == REFUTED)
