"""The division of a list of logs into parts, by names alone, so that a new log changes one part."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence

AVERAGE = 64
"""The average number of logs of a part: one name in so many ends it."""
MOST = 2 * AVERAGE
"""The most logs of a part."""


def parts(names: Sequence[str]) -> Iterator[range]:
    """The indices of each part's logs, in their order.

    Args:
        names: the names of the logs.
    """
    start = 0
    for place, name in enumerate(names):
        if _ends(name) or place - start + 1 == MOST:
            yield range(start, place + 1)
            start = place + 1
    if start < len(names):
        yield range(start, len(names))


def _ends(name: str) -> bool:
    digest = hashlib.sha256(name.encode("utf-8", "surrogateescape")).digest()
    return int.from_bytes(digest[:8], "big") % AVERAGE == 0
