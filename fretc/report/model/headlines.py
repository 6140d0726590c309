"""The headline of a report: what is violated, what is out of date, and which change made it so."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fretc.report.model import phrases
from fretc.report.model.claims import Claim

_GROUPS = 3
"""Different reasons that are named; of the others only the number is."""


def broken(claims: Sequence[Claim]) -> str:
    """What is violated, as `R1 is violated; R2 was violated, and the sentence has changed`.

    Args:
        claims: at least one, all of them violated or refuted.
    """
    current = [claim for claim in claims if not claim.suspicions]
    stale = [claim for claim in claims if claim.suspicions]
    parts = [f"{_named(current)} {' or '.join(_words(current))}"] if current else []
    return f"{'; '.join([*parts, *_groups(stale)])}."


def outdated(claims: Sequence[Claim]) -> str:
    """What is suspect and no violation, with its reasons, as a sentence; empty: nothing is."""
    stale = [claim for claim in claims if claim.suspicions and not claim.is_broken]
    return f"{'; '.join(_groups(stale))}." if stale else ""


def _groups(stale: Sequence[Claim]) -> list[str]:
    """Those of one verdict that are suspect for the same reasons together, the worst first."""
    ordered = sorted(stale, key=lambda claim: (claim.mark.severity, claim.suspicions))
    groups = [
        (list(same), reasons)
        for (_, reasons), same in groupby(
            ordered, key=lambda claim: (claim.mark.word, claim.suspicions)
        )
    ]
    told = [
        f"{_named(same, 'was', 'were')} {same[0].mark.word}, and {phrases.joined(reasons)}"
        for same, reasons in groups[:_GROUPS]
    ]
    rest = sum(len(same) for same, _ in groups[_GROUPS:])
    return [*told, f"{phrases.times(rest, 'more requirement')} suspect"] if rest else told


def _named(claims: Sequence[Claim], one: str = "is", many: str = "are") -> str:
    return f"{phrases.some([claim.id for claim in claims])} {one if len(claims) == 1 else many}"


def _words(claims: Sequence[Claim]) -> Sequence[str]:
    return list(dict.fromkeys(claim.mark.word for claim in claims))
