"""Views of the analysis of all requirements together."""

from __future__ import annotations

from fretc.report.model.marks import Mark
from fretish.classes.frozen import dataclass

REALIZABLE, UNREALIZABLE = "can be satisfied together", "cannot be satisfied together"


@dataclass(frozen=True, slots=True)
class PlayLane:
    """A variable in a run; `role` is "" if the lane is not a single variable."""

    name: str
    role: str
    values: tuple[str, ...]
    """The value in each column; `0` and `1` are truth values."""


@dataclass(frozen=True, slots=True)
class Play:
    """A run, tick by tick; equal ticks in a row share a column: `3..7`."""

    ticks: tuple[str, ...]
    lanes: tuple[PlayLane, ...]
    loop: int | None
    """The column to which the last one loops back; None if the run ends in a violation."""


@dataclass(frozen=True, slots=True)
class SetMember:
    """An analyzed requirement; `anchor` is "" if it no longer exists."""

    requirement: str
    anchor: str
    sentence: str


@dataclass(frozen=True, slots=True)
class SetComponent:
    """Requirements that share outputs, and whether they are realizable."""

    mark: Mark
    members: tuple[SetMember, ...]
    outputs: tuple[str, ...]
    why: str


@dataclass(frozen=True, slots=True)
class SetConflict:
    """Requirements that are unrealizable together, from the start or after the given run."""

    members: tuple[SetMember, ...]
    because: str
    play: Play


@dataclass(frozen=True, slots=True)
class SetAnalysis:
    """The result of `fretc analyze` for all requirements together."""

    file: str
    fretc: str
    """The version of fretc that made the analysis."""
    mark: Mark
    headline: str
    suspicions: tuple[str, ...]
    """The reasons why the analysis is suspect."""
    left_out: tuple[str, ...]
    """Requirements in force that were not analyzed, because they have no formula."""
    components: tuple[SetComponent, ...]
    conflicts: tuple[SetConflict, ...]
    complete: bool
    """Whether all minimal conflicts are listed."""
    clashes: tuple[SetConflict, ...]
    """Real-time inconsistencies."""
    remarks: tuple[str, ...]
    """Remarks on requirements that are redundant, never triggered, always or never satisfied."""
    assumptions: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    terms: tuple[str, ...]
    """The conditions of all results."""
    open: tuple[str, ...]
    """Questions without an answer, with the reason."""

    @property
    def is_good(self) -> bool:
        """Whether all present requirements in force are realizable together."""
        return self.mark.word == REALIZABLE and not self.mark.suspect and not self.left_out

    @property
    def is_broken(self) -> bool:
        """Whether the requirements are unrealizable together."""
        return self.mark.word == UNREALIZABLE
