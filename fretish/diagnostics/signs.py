"""The signs of all outcomes, of verdicts and proofs as of logs and reviews: one table.

An outcome has its own word, and one of these signs; its colour is never all that tells it.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Sign:
    """How an outcome looks."""

    glyph: str
    letter: str
    """In its place, where a terminal cannot write it."""
    kind: str
    """Its class in the report's style sheet."""
    colour: str
    """In a terminal."""


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
