"""A figure beside its limit: what `python -m benchmarks` prints of each benchmark."""

from __future__ import annotations

from dataclasses import dataclass

RUNS = 7
"""Of each command and its peer, in turn; a figure is the median."""


@dataclass(frozen=True)
class Figure:
    """What people wait for, as a multiple of a named peer, or in seconds or MB."""

    what: str
    value: float
    unit: str
    """What the value is in: `x csv.reader`, `s of CPU`."""
    limit: float
    at_least: bool = False
    """The value must be no less than the limit: a rate beside a peer's."""

    @property
    def is_met(self) -> bool:
        return self.value >= self.limit if self.at_least else self.value <= self.limit

    def __str__(self) -> str:
        sign = "≥" if self.at_least else "≤"
        mark = "" if self.is_met else "  missed"
        value = f"{self.value:,.0f}" if self.value >= 1000 else f"{self.value:.2f}"
        return f"{self.what:46} {value:>9} {sign} {self.limit:<7,g} {self.unit}{mark}"
