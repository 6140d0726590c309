"""The symbol, level and severity of every verdict, the worst first.

A verdict is what the evidence shows. Whether it is about the requirement as it is now is another
fact, its currency: a verdict is suspect where something that it rests on has changed. A suspect
verdict never counts as shown, and one that tells of a violation stays one.

Sources: the JUnit schema of the Jenkins xUnit plugin; OASIS, SARIF Version 2.1.0, `level`.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from fretc.audit.measurements.confidence_intervals import REFUTED, SUPPORTED
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol
from monitors import kernel

UNFORMALIZED = "unformalized"
NOT_EXERCISED = "not exercised"
RETIRED = "retired"
WAIVED = "waived"
ASSUMPTION_BROKEN = "assumption broken"
"""The verdict of an assumption where a requirement would be violated."""
SUSPECT, CURRENT = "suspect", "current"
"""The currency of a verdict: whether its inputs are unchanged."""


class MessageLevel(StrEnum):
    """The level of a verdict as a message."""

    ERROR = "error"
    WARNING = "warning"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class DisplayedVerdict:
    """A verdict with its symbol, its level and its JUnit element."""

    word: str
    sign: StatusSymbol
    level: MessageLevel
    junit: str
    """The element of JUnit; empty: the case passes."""


_ERROR, _WARNING, _NONE = MessageLevel.ERROR, MessageLevel.WARNING, MessageLevel.NONE
VERDICTS: Mapping[str, DisplayedVerdict] = {
    each.word: each
    for each in (
        DisplayedVerdict(kernel.VIOLATED, signs.BAD, _ERROR, "failure"),
        DisplayedVerdict(REFUTED, signs.BAD, _ERROR, "failure"),
        DisplayedVerdict(ASSUMPTION_BROKEN, signs.FLAWED, _WARNING, "error"),
        DisplayedVerdict(UNFORMALIZED, signs.FLAWED, _ERROR, "error"),
        DisplayedVerdict(kernel.NO_DATA, signs.UNKNOWN, _WARNING, "error"),
        DisplayedVerdict(kernel.INCONCLUSIVE, signs.OPEN, _WARNING, "skipped"),
        DisplayedVerdict(kernel.VACUOUS, signs.EMPTY, _WARNING, "skipped"),
        DisplayedVerdict(NOT_EXERCISED, signs.UNUSED, _WARNING, "skipped"),
        DisplayedVerdict(WAIVED, signs.WAIVED, _WARNING, "skipped"),
        DisplayedVerdict(SUPPORTED, signs.GOOD, _NONE, ""),
        DisplayedVerdict(kernel.SATISFIED, signs.GOOD, _NONE, ""),
        DisplayedVerdict(RETIRED, signs.RETIRED, _NONE, "skipped"),
    )
}
"""Verdicts by word. The verdict of several runs is their worst."""
BROKEN = (kernel.VIOLATED, REFUTED)
"""The verdicts that report a violation by the system."""
SHOWN = (kernel.SATISFIED, SUPPORTED)
"""The verdicts that show a requirement, unless they are suspect."""
_RANK = {word: rank for rank, word in enumerate(VERDICTS)}


def of_kind(word: str, *, is_assumption: bool) -> str:
    """The verdict of a run, which says apart whether a requirement or an assumption is broken."""
    broken = word in (kernel.VIOLATED, ASSUMPTION_BROKEN)
    return word if not broken else ASSUMPTION_BROKEN if is_assumption else kernel.VIOLATED


def shows(word: str, *, suspect: bool) -> bool:
    """Whether a verdict shows its requirement."""
    return word in SHOWN and not suspect


def severity(word: str, *, suspect: bool = False) -> tuple[int, bool]:
    """The order of verdicts, the worst first.

    A suspect verdict follows the current one of its word; a suspect verdict that would otherwise
    show its requirement comes after all that do not show theirs.
    """
    rank = _RANK[WAIVED] if suspect and word in SHOWN else _RANK[word]
    return rank, suspect


def level(word: str, *, suspect: bool = False) -> MessageLevel:
    """The level of a verdict: a suspect one is a warning at least."""
    own = VERDICTS[word].level
    return MessageLevel.WARNING if suspect and own is MessageLevel.NONE else own


def junit(word: str, *, suspect: bool = False) -> str:
    """The element of JUnit: a suspect verdict is a failure at least."""
    own = VERDICTS[word].junit
    return "failure" if suspect and own in ("", "skipped") else own
