"""The order in which people count: R2 comes before R10; and of diagnostics, by their places."""

from __future__ import annotations

import re
from collections.abc import Iterable

from fretish.diagnostics.diagnostic import Diagnostic

Key = tuple[tuple[str | tuple[int, str], ...], str]


def natural(name: str) -> Key:
    """What to sort by: digits that follow each other are one number.

    The texts order equal numbers that are written differently (`R2`, `R02`).
    """
    parts = re.split("([0-9]+)", name)
    return tuple(_number(part) if i % 2 else part for i, part in enumerate(parts)), name


def _number(digits: str) -> tuple[int, str]:
    """As comparable as the number, however long it is."""
    shortest = digits.lstrip("0")
    return len(shortest), shortest


def by_place(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """By file, line and column. First comes what has no place; equal places stay as they are."""
    return sorted(diagnostics, key=_place)


def _place(diagnostic: Diagnostic) -> tuple[Key, int] | tuple[()]:
    span = diagnostic.span
    return () if span is None else (natural(span.source.name), span.start)
