"""All runs in one picture: a lane a run, and how much of each bound a run has used.

Times are seconds from the first tick of a run; texts say the same as the pictures.
"""

from __future__ import annotations

from dataclasses import dataclass

from fretc.report.model.marks import Mark
from fretc.report.model.pictures import WordLane


@dataclass(frozen=True, slots=True)
class LaneMark:
    """Stretches of one kind that lie side by side; `anchor` is that of the result of the first."""

    kind: str
    """`violated`, `unknown` or `open`."""
    start: float
    end: float
    count: int
    """Of stretches; of open demands at the end."""
    requirements: tuple[str, ...]
    """Those of the stretches, each once, that of the first one first."""
    anchor: str
    section: str
    """The anchor of the first requirement."""
    number: int
    """Of the first violation in its result, from 1; 0: it is none."""
    text: str


@dataclass(frozen=True, slots=True)
class RunLane:
    """One run: its verdict, and when something was violated, unknown or open."""

    anchor: str
    label: str
    file: str
    mark: Mark
    length: float
    marks: tuple[LaneMark, ...]
    words: tuple[WordLane, ...] = ()


@dataclass(frozen=True, slots=True)
class Lanes:
    """A lane a run; `left_out` counts the runs without a lane, none of which is worse."""

    title: str
    end: float
    lanes: tuple[RunLane, ...]
    left_out: str
    text: str


@dataclass(frozen=True, slots=True)
class Use:
    """How much of a bound a run has used; `measure` is the letter of the bound in its picture."""

    measure: str
    share: float | None
    """1 is all of it; None: it was crossed, and nothing says by how much."""
    is_crossed: bool
    text: str


@dataclass(frozen=True, slots=True)
class UseRow:
    """One run, with what it has used of each bound, the most used first."""

    label: str
    file: str
    mark: Mark
    anchor: str
    section: str
    uses: tuple[Use, ...]


@dataclass(frozen=True, slots=True)
class Uses:
    """The runs of a requirement by what they used of its bounds, the most used first."""

    title: str
    measures: tuple[tuple[str, str], ...]
    """Letter and bound."""
    rows: tuple[UseRow, ...]
    notes: tuple[str, ...]
    """What has no row, and why."""
    text: str


@dataclass(frozen=True, slots=True)
class RequirementAcross:
    """All runs of one requirement."""

    requirement: str
    anchor: str
    lanes: Lanes | None
    uses: Uses | None


@dataclass(frozen=True, slots=True)
class PlaceMark:
    """Where violations began that lie side by side; fields as of `LaneMark`."""

    x: float
    y: float
    count: int
    requirements: tuple[str, ...]
    anchor: str
    section: str
    number: int
    text: str


@dataclass(frozen=True, slots=True)
class RunMap:
    """The way of the robot in one run, in metres, with each violation where it began."""

    anchor: str
    label: str
    file: str
    mark: Mark
    lines: tuple[tuple[tuple[float, float], ...], ...]
    marks: tuple[PlaceMark, ...]
    unplaced: int
    """Violations that began where the place of the robot is unknown."""
    text: str


@dataclass(frozen=True, slots=True)
class Across:
    """All runs of all requirements, and those of each."""

    lanes: Lanes | None
    requirements: tuple[RequirementAcross, ...]
    maps: tuple[RunMap, ...]
    """Of the runs with a way, the worst first."""
    maps_left_out: str
    """How many runs with a way have no map; empty: none."""
