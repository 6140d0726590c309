"""How hard tests try: every case with the full profile of hypothesis, else one here and there.

Logs that others have recorded are read where `FRETC_LOGS` names their folder, and FRET's case
studies where `FRETC_FRET` names a clone of FRET.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Iterable, Sequence
from itertools import cycle, product
from pathlib import Path
from typing import Any, TypeVar

import pytest
from hypothesis import settings

Case = TypeVar("Case")
FULL = settings().max_examples > 1000
LOGS = Path(os.environ.get("FRETC_LOGS", ""))
FRET = Path(os.environ.get("FRETC_FRET", ""))
needs_logs = pytest.mark.skipif(
    "FRETC_LOGS" not in os.environ, reason="set FRETC_LOGS to the folder of the public logs"
)

needs_fret = pytest.mark.skipif(
    "FRETC_FRET" not in os.environ, reason="set FRETC_FRET to a clone of NASA-SW-VnV/fret"
)


def _calls_through_c(depth: int) -> bool:
    """Whether functions may call each other through C so many times deep."""

    @functools.cache
    def deep(left: int) -> int:
        return deep(left - 1) if left else 0

    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(10 * depth)
    try:
        return deep(depth) == 0
    except RecursionError:
        return False
    finally:
        sys.setrecursionlimit(limit)


needs_deep_calls = pytest.mark.skipif(
    not _calls_through_c(1_500), reason="this Python calls through C only some hundred times deep"
)
"""CPython 3.12.1 allows 500: there deep sentences are refused earlier (F115)."""


def full_only(why: str) -> pytest.MarkDecorator:
    """Skip a test but with the full profile."""
    return pytest.mark.skipif(not FULL, reason=f"{why}: HYPOTHESIS_PROFILE=full")


def some(cases: Iterable[Case], step: int, first: int = 0) -> list[Case]:
    """Return every `step`-th of the cases from the place `first` on; all with the full profile."""
    return [*cases] if FULL else [*cases][first::step]


def examples(count: int) -> settings:
    """Draw so many examples, where one takes long; with the full profile as many as it says."""
    return settings() if FULL else settings(max_examples=count)


def by_turns(cases: Iterable[Any], *ways: Any) -> list[tuple[Any, Any]]:
    """Return each case with one of the ways, by turns; with each way with the full profile."""
    return [*product(cases, ways)] if FULL else [*zip(cases, cycle(ways))]


def pairwise(*axes: Sequence[Any]) -> list[tuple[Any, ...]]:
    """Return combinations in which any two values of two axes meet; all with the full profile."""
    if FULL:
        return [*product(*axes)]
    return [tuple(axis[i] for axis, i in zip(axes, row, strict=True)) for row in _rows(axes)]


def _rows(axes: Sequence[Sequence[Any]]) -> list[list[int]]:
    """The places of the values: one axis after the other is added, and rows where pairs lack."""
    rows = [[first] for first in range(len(axes[0]))]
    for at, axis in enumerate(axes[1:], 1):
        lacking = {
            (place, value, new)
            for place, before in enumerate(axes[:at])
            for value in range(len(before))
            for new in range(len(axis))
        }
        for number, row in enumerate(rows):
            turns = [(number + turn) % len(axis) for turn in range(len(axis))]
            new = max(turns, key=lambda new: sum((*p, new) in lacking for p in enumerate(row)))
            lacking -= {(*p, new) for p in enumerate(row)}
            row.append(new)
        for place, value, new in sorted(lacking):
            if (place, value, new) in lacking:
                row = [(value + new + i) % len(before) for i, before in enumerate(axes[:at])]
                row[place] = value
                lacking -= {(*p, new) for p in enumerate(row)}
                rows.append([*row, new])
    return rows
