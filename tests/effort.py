"""How hard tests try: every case with the full profile of hypothesis, else one here and there."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from hypothesis import settings

Case = TypeVar("Case")
FULL = settings().max_examples > 1000


def some(cases: Iterable[Case], step: int, first: int = 0) -> list[Case]:
    """Return every `step`-th of the cases from the place `first` on; all with the full profile."""
    return [*cases] if FULL else [*cases][first::step]
