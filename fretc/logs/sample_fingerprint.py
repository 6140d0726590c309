"""A fingerprint of the samples of a log, to recognize logs of one run."""

from __future__ import annotations

import hashlib
import json

import numpy as np

from fretc.logs.signals.samples import Recording, Samples, Values


def fingerprint(recording: Recording) -> str | None:
    """SHA-256 of the times and values of all signals that were read; None: there are none.

    A copy of a log by another tool, with other metadata, chunks or compression, has the same
    fingerprint. All unknown values are equal, and so are the number types.
    """
    if not any(len(samples.times) for samples in recording.samples.values()):
        return None
    digest = hashlib.sha256()
    for name, samples in sorted(recording.samples.items()):
        values = _in_order(samples).astype(np.float64)
        values[np.isnan(values)] = np.nan
        words = json.dumps(sorted(samples.words)) if samples.words else ""
        digest.update(f"{name} {len(values)} {samples.scale}{words}\n".encode())
        digest.update(samples.times.astype("<i8").tobytes())
        digest.update(values.astype("<f8").tobytes())
    digest.update(np.asarray(recording.ticks).astype("<i8").tobytes())
    return digest.hexdigest()


def _in_order(samples: Samples) -> Values:
    """The values; indices of enumeration values are renumbered in order of their texts."""
    if not samples.words:
        return samples.values
    ranks = np.array([sorted(samples.words).index(word) for word in samples.words], np.float64)
    is_known = ~np.isnan(samples.values)
    ordered = np.full(len(samples.values), np.nan)
    ordered[is_known] = ranks[samples.values[is_known].astype(np.intp)]
    return ordered
