"""The content of the report's pictures; `fretc.report.pictures.plots` has the layout.

Times are seconds from the first tick of a run.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SpanMark:
    """An interval on a lane of a timeline, and the number of events in it."""

    start: float
    end: float
    count: int


@dataclass(frozen=True, slots=True)
class Lane:
    """One kind of event on a timeline."""

    name: str
    kind: str
    marks: tuple[SpanMark, ...]


@dataclass(frozen=True, slots=True)
class Piece:
    """A signal while it is known; a point `(seconds, least, greatest)` holds up to the next one."""

    points: tuple[tuple[float, float, float], ...]
    end: float


@dataclass(frozen=True, slots=True)
class Level:
    """The bound of a threshold and its label."""

    value: float
    label: str


@dataclass(frozen=True, slots=True)
class Panel:
    """One signal over a timeline, from `low` to `high` in `unit`."""

    signal: str
    unit: str
    low: float
    high: float
    pieces: tuple[Piece, ...]
    levels: tuple[Level, ...]
    unknown: tuple[SpanMark, ...]
    infinite: tuple[tuple[float, float, str], ...]
    """From, to, and `+inf` or `-inf`."""


@dataclass(frozen=True, slots=True)
class WordLane:
    """A signal of words over a timeline: (from, to, word); None if unknown."""

    signal: str
    words: tuple[tuple[float, float, str | None], ...]


@dataclass(frozen=True, slots=True)
class Flag:
    """An instant with a name: the trigger, the deadline."""

    kind: str
    at: float


@dataclass(frozen=True, slots=True)
class Timeline:
    """A picture of an interval of a run; `text` describes it."""

    title: str
    start: float
    end: float
    lanes: tuple[Lane, ...]
    text: str
    panels: tuple[Panel, ...] = ()
    words: tuple[WordLane, ...] = ()
    flags: tuple[Flag, ...] = ()
    broken: SpanMark | None = None
    cause: str = ""
    """Cause of the violation in words; "" without a violation."""


@dataclass(frozen=True, slots=True)
class Bin:
    """The count of values from `low` to below `high`; of latencies: above `low`, up to `high`."""

    low: float
    high: float
    count: int


@dataclass(frozen=True, slots=True)
class Histogram:
    """The counts of values in bins; `text` has the numbers in words."""

    title: str
    unit: str
    bins: tuple[Bin, ...]
    bound: float | None
    """The limit of the values, or None."""
    bound_label: str
    text: str
    crossed: int = 0
    """Runs without a value, because they crossed the bound."""
    unanswered: int = 0
    """Triggers without a value, because their time or scope ended without an answer."""
    open: int = 0
    """Triggers without a value, because they still waited when the log ended."""
