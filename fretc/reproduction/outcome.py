"""The outcome of a recheck: reproduced, different, or not checked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from enum import StrEnum

from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol

FILE, ALL_RUNS, PROOFS, TOGETHER = "the file", "all runs", "proofs", "all together"
"""Names that are used instead of the name of a run."""


class ItemOutcome(StrEnum):
    """The outcome for one item."""

    STANDS = "stands"
    DIFFERS = "differs"
    UNKNOWN = "not checked"


SIGNS: Mapping[ItemOutcome, StatusSymbol] = {
    ItemOutcome.STANDS: signs.GOOD,
    ItemOutcome.DIFFERS: signs.BAD,
    ItemOutcome.UNKNOWN: signs.UNKNOWN,
}


@dataclass(frozen=True, slots=True)
class Recheck:
    """The comparison of one item with the evidence."""

    run: str
    requirement: str
    """The requirement; "" if the item is about all of them."""
    finding: ItemOutcome
    reasons: tuple[str, ...]
    """The reasons; empty if the item is reproduced."""
    claim: str = ""
    """The claim of a proof or analysis; "" for other items."""


def differs(run: str, requirement: str, *reasons: str, claim: str = "") -> Recheck:
    """An item that differs."""
    return Recheck(run, requirement, ItemOutcome.DIFFERS, reasons, claim)


def unknown(run: str, requirement: str, *reasons: str, claim: str = "") -> Recheck:
    """An item that could not be computed again."""
    return Recheck(run, requirement, ItemOutcome.UNKNOWN, reasons, claim)


def counts(rechecks: Iterable[Recheck]) -> Mapping[ItemOutcome, int]:
    """The number of items by finding."""
    number = Counter(recheck.finding for recheck in rechecks)
    return {finding: number[finding] for finding in ItemOutcome}
