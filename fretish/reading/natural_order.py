"""Sort names in natural order (R2 before R10), and diagnostics by position."""

from __future__ import annotations

import re
from collections.abc import Iterable

from fretish.diagnostics.diagnostic import Diagnostic

Key = tuple[tuple[str | tuple[int, str], ...], str]


def natural(name: str) -> Key:
    """The sort key of a name: consecutive digits are one number.

    Names with equal numbers (`R2`, `R02`) are ordered by their text.
    """
    parts = re.split("([0-9]+)", name)
    return tuple(_number(part) if i % 2 else part for i, part in enumerate(parts)), name


def _number(digits: str) -> tuple[int, str]:
    """A key that orders digit strings like their numbers, for any length."""
    shortest = digits.lstrip("0")
    return len(shortest), shortest


def by_place(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Sort by file and position, in a stable order; diagnostics without a span come first."""
    return sorted(diagnostics, key=_place)


def _place(diagnostic: Diagnostic) -> tuple[Key, int] | tuple[()]:
    span = diagnostic.span
    return () if span is None else (natural(span.source.name), span.start)
