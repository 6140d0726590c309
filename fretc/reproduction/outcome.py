"""The outcome of making a thing again: it stands, it differs, or it was not checked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol

FILE, ALL_RUNS, PROOFS, TOGETHER = "the file", "all runs", "proofs", "all together"
"""In the place of a run."""


class Finding(StrEnum):
    """The outcome for one thing."""

    STANDS = "stands"
    DIFFERS = "differs"
    UNKNOWN = "not checked"


SIGNS: Mapping[Finding, StatusSymbol] = {
    Finding.STANDS: signs.GOOD,
    Finding.DIFFERS: signs.BAD,
    Finding.UNKNOWN: signs.UNKNOWN,
}


@dataclass(frozen=True, slots=True)
class Recheck:
    """The comparison of one run and requirement with the evidence; or what is missing there."""

    run: str
    requirement: str
    """Empty where it is about all of them."""
    finding: Finding
    reasons: tuple[str, ...]
    """Empty where it stands."""
    claim: str = ""
    """What is proved of the requirement; empty where it is about no proof."""


def differs(run: str, requirement: str, *reasons: str, claim: str = "") -> Recheck:
    """The present thing differs."""
    return Recheck(run, requirement, Finding.DIFFERS, reasons, claim)


def unknown(run: str, requirement: str, *reasons: str, claim: str = "") -> Recheck:
    """It could not be made again."""
    return Recheck(run, requirement, Finding.UNKNOWN, reasons, claim)


def counts(rechecks: Iterable[Recheck]) -> Mapping[Finding, int]:
    """How many there are of each finding."""
    number = Counter(one.finding for one in rechecks)
    return {finding: number[finding] for finding in Finding}
