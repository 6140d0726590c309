"""The order in which people count: R2 comes before R10."""

from __future__ import annotations

import re

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
