"""The status symbols of verdicts, proofs, logs and reviews, in one table.

A status is always displayed with its own word, too, so that it never depends on colour alone.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Sign:
    """How a status is displayed."""

    glyph: str
    letter: str
    """The replacement for `glyph` on an ASCII terminal."""
    kind: str
    """The CSS class in the report."""
    colour: str
    """The colour in a terminal."""


GOOD = Sign("✔", "+", "satisfied", "green")
BAD = Sign("✘", "X", "violated", "red")
FLAWED = Sign("!", "!", "unformalized", "red")
UNKNOWN = Sign("?", "?", "no-data", "magenta")
OPEN = Sign("◔", "~", "inconclusive", "yellow")
EMPTY = Sign("∅", "0", "vacuous", "bright_black")
UNUSED = Sign("○", "o", "not-exercised", "bright_black")
WAIVED = Sign("w", "w", "waived", "blue")
RETIRED = Sign("\N{EN DASH}", "-", "retired", "bright_black")
SUSPECT = Sign("⚠", "*", "suspect", "yellow")
SIGNS = (GOOD, BAD, FLAWED, UNKNOWN, OPEN, EMPTY, UNUSED, WAIVED, RETIRED, SUSPECT)
