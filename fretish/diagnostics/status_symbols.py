"""The status symbols of verdicts, proofs, logs and reviews, in one table.

A status is always displayed with its own word, too, so that it never depends on colour alone.
"""

from __future__ import annotations

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class StatusSymbol:
    """How a status is displayed."""

    glyph: str
    letter: str
    """The replacement for `glyph` on an ASCII terminal."""
    kind: str
    """The CSS class in the report."""
    colour: str
    """The colour in a terminal."""


GOOD = StatusSymbol("✔", "+", "satisfied", "green")
BAD = StatusSymbol("✘", "X", "violated", "red")
FLAWED = StatusSymbol("!", "!", "unformalized", "red")
UNKNOWN = StatusSymbol("?", "?", "no-data", "magenta")
OPEN = StatusSymbol("◔", "~", "inconclusive", "yellow")
EMPTY = StatusSymbol("∅", "0", "vacuous", "bright_black")
UNUSED = StatusSymbol("○", "o", "not-exercised", "bright_black")
WAIVED = StatusSymbol("w", "w", "waived", "blue")
RETIRED = StatusSymbol("\N{EN DASH}", "-", "retired", "bright_black")
SUSPECT = StatusSymbol("⚠", "*", "suspect", "yellow")
STATUS_SYMBOLS = (GOOD, BAD, FLAWED, UNKNOWN, OPEN, EMPTY, UNUSED, WAIVED, RETIRED, SUSPECT)
