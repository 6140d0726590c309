"""The gravity of a requirement: the most severe hazard above it.

A project writes severities in its own words. Those of MIL-STD-882E, ARP4761, ISO 26262 (S0 to S3)
and ISO 13849 (serious, slight) have a rank here. A word that has none counts as the most severe:
its requirement is named first, never last.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from fretc.report.model.views import HazardRequirement, HazardView
from fretish.classes.frozen import dataclass
from fretish.reading.natural_order import natural

_RANKS = {
    word: rank
    for rank, words in enumerate(
        (
            "catastrophic s3",
            "critical hazardous severe fatal",
            "serious major high s2",
            "marginal moderate medium minor slight low s1",
            "negligible none s0",
        )
    )
    for word in words.split()
}
_LEAST = len({*_RANKS.values()})


@dataclass(frozen=True, slots=True)
class Gravity:
    """The most severe hazard above a requirement: its rank (0: the most severe) and its name."""

    rank: int
    hazard: str
    severity: str
    """In the words of the project; "" if it states none."""

    @property
    def text(self) -> str:
        """`HAZ-001, catastrophic`; "" if there is no hazard."""
        return ", ".join(filter(None, (self.hazard, self.severity)))


NO_HAZARD = Gravity(_LEAST + 1, "", "")


def gravities(
    rows: Iterable[HazardRequirement], hazards: Iterable[HazardView]
) -> Mapping[str, Gravity]:
    """Anchor of a requirement → its gravity.

    Args:
        rows: the rows of the matrix.
        hazards: all hazards of the project.
    """
    severities = {hazard.id: hazard.severity for hazard in hazards}
    found: dict[str, Gravity] = {}
    for row in rows:
        new = _gravity(row.hazard, severities.get(row.hazard, ""))
        old = found.setdefault(row.anchor, new)
        if _key(new) < _key(old):
            found[row.anchor] = new
    return found


def _gravity(hazard: str, severity: str) -> Gravity:
    if not hazard:
        return NO_HAZARD
    rank = _RANKS.get(severity.strip().casefold(), 0) if severity.strip() else _LEAST
    return Gravity(rank, hazard, severity)


def _key(gravity: Gravity) -> tuple[int, object]:
    return gravity.rank, natural(gravity.hazard)
