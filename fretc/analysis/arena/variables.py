"""Fresh variables of decision diagrams, and the error for unsupported requirements."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count


class UnsupportedError(Exception):
    """The analysis has no model of a construct; the message names the construct."""


Numbers = Iterator[int]
"""Unused variables in order; the next one is free."""


def numbers(start: int = 0) -> Numbers:
    """All of them, from one on."""
    return count(start)
