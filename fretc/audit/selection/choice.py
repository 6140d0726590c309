"""The selection of the named logs that are audited, and its record for the evidence."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from datetime import datetime

from fretc.audit.evidence.schema import Selection
from fretc.logs.storage.log_names import name_of


def chosen(
    logs: Sequence[str], than: datetime | None, sample: int | None, seed: int
) -> tuple[list[str], Selection | None]:
    """The selected logs in their order, with the record; no record if all named logs are audited.

    Args:
        logs: the named logs.
        than: the time before which logs are left out; None: none is.
        sample: the size of the random sample; None: all.
        seed: the seed: equal seeds and names give equal samples.
    """
    if than is None and sample is None:
        return [*logs], None
    from fretc.audit.selection.dates import is_older  # It reads logs.

    recent = [log for log in logs if than is None or not is_older(log, than)]
    selected = recent if sample is None else _sample(recent, sample, seed)
    return selected, Selection(
        named=len(logs),
        since=than.isoformat() if than is not None else None,
        older=len(logs) - len(recent),
        sample_of=None if sample is None else len(recent),
        seed=None if sample is None else seed,
        audited=len(selected),
    )


def _sample(logs: Sequence[str], count: int, seed: int) -> list[str]:
    """The logs with the least hashes, so that one more log displaces at most one of them."""
    keys = {log: hashlib.sha256(f"{seed}\n{name_of(log)}".encode()).digest() for log in logs}
    taken = set(sorted(logs, key=lambda log: (keys[log], log))[:count])
    return [log for log in logs if log in taken]


def in_words(selection: Selection) -> str:
    """The selection in words: `20 of 1,000 logs: 400 are from before 2026-11-22T00:00:00+00:00`."""
    parts = []
    if selection.since is not None:
        parts.append(f"{selection.older:,} are from before {selection.since}")
    if selection.sample_of is not None:
        parts.append(f"a sample of {selection.sample_of:,} chosen at random, seed {selection.seed}")
    return f"{selection.audited:,} of {selection.named:,} logs: {'; '.join(parts)}"
