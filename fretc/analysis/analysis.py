"""The analysis of a requirement set: every question of it, component by component."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from compiler.formalization.formalized import Formalized
from fretc.analysis.arena.roles import Roles
from fretc.analysis.findings import Analysis


@dataclass(frozen=True, slots=True)
class Options:
    """What a caller may choose."""

    seconds: float = 20.0
    """Of a processor, for each question about each component."""
    as_fret: bool = False
    """FRET's question: the past form of each requirement holds at every tick, so that `eventually`
    means at once."""
    progress: Callable[[str], None] = lambda words: None
    """Is called with what is being looked at."""


DEFAULT = Options()


def analyze(
    rules: Sequence[Formalized],
    roles: Roles,
    assumptions: Sequence[Formalized] = (),
    options: Options = DEFAULT,
) -> Analysis:
    """All that can be known of the requirements together.

    Args:
        rules: the requirements, in the order of the files.
        roles: of every variable of rules and assumptions (`roles`).
        assumptions: what the environment keeps.
        options: limits, and FRET's reading.
    """
    raise NotImplementedError
