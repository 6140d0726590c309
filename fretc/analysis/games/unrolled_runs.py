"""Answers about requirements without inputs that are unrolled tick by tick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fretish.classes.frozen import dataclass

if TYPE_CHECKING:
    from compiler.formalization.numbers.terms import Term

LONGEST = 40
"""Maximum number of ticks of a run."""


@dataclass(frozen=True, slots=True)
class SatisfyingRun:
    """A run that satisfies all requirements, and the tick at which its repeated part begins."""

    numbers: tuple[Mapping[str, Term], ...]
    """The value of each variable, for each tick."""
    others: tuple[Mapping[int, bool], ...]
    """The bits of an alphabet that are not about numbers, for each tick."""
    loop: int | None
    """None: the run does not return."""


@dataclass(frozen=True, slots=True)
class NoShortRun:
    """No run of so many ticks satisfies all requirements."""

    ticks: int
    of: frozenset[str]
    """Ids of requirements that no such run satisfies, among those that were asked for."""
