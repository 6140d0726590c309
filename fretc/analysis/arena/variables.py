"""Fresh variables of decision diagrams, and what an arena has no model of."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count


class UnsupportedError(Exception):
    """Something that the analysis has no model of; the message says what, in words."""


Numbers = Iterator[int]
"""Variables that nothing has yet, in their order: the next one is free."""


def numbers(start: int = 0) -> Numbers:
    """All of them, from one on."""
    return count(start)
