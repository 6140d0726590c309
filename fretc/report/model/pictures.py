"""The content of the report's pictures, of one run and of all runs together.

`fretc.report.pictures.plots` and `fretc.report.across.layout` have the layout. Times are seconds
from the first tick of a run. Texts describe the pictures.
"""

from __future__ import annotations

from fretc.report.model.marks import Mark
from fretish.classes.frozen import dataclass


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
class SignalPiece:
    """A signal while it is known; a point `(seconds, least, greatest)` holds up to the next one."""

    points: tuple[tuple[float, float, float], ...]
    end: float


@dataclass(frozen=True, slots=True)
class ThresholdLine:
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
    pieces: tuple[SignalPiece, ...]
    levels: tuple[ThresholdLine, ...]
    unknown: tuple[SpanMark, ...]
    infinite: tuple[tuple[float, float, str], ...]
    """From, to, and `+inf` or `-inf`."""
    is_enlarged: bool = False
    """Whether it repeats a part of the panel before it; values outside it lie on its edge."""


@dataclass(frozen=True, slots=True)
class WordLane:
    """A signal of words over a timeline: (from, to, word); None if unknown."""

    signal: str
    words: tuple[tuple[float, float, str | None], ...]


@dataclass(frozen=True, slots=True)
class NamedInstant:
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
    flags: tuple[NamedInstant, ...] = ()
    broken: SpanMark | None = None
    cause: str = ""
    """Cause of the violation in words; "" without a violation."""
    continues: float | None = None
    """The end of the violation if it is after `end`; None if it is not."""
    epoch_ns: int | None = None
    """The time of second 0 on the clock of the log; None without a violation."""


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


# All runs together -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class LaneMark:
    """Adjacent intervals of one kind; `anchor` is the anchor of the first result."""

    kind: str
    """`violated`, `unknown` or `open`."""
    start: float
    end: float
    count: int
    """Number of intervals, or of open obligations at the end."""
    requirements: tuple[str, ...]
    """Ids of the requirements of the intervals, in order of appearance."""
    anchor: str
    section: str
    """The anchor of the first requirement."""
    number: int
    """Number of the first violation in its result, from 1; 0 if the mark is not a violation."""
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
    is_damaged: bool = False
    """Whether messages of the log may be lost, so that the run may go on after the lane."""


@dataclass(frozen=True, slots=True)
class Lanes:
    """One lane per run, or per requirement if there is one run.

    `left_out` counts the runs without a lane, none of which is worse.
    """

    title: str
    end: float
    lanes: tuple[RunLane, ...]
    left_out: str
    text: str


@dataclass(frozen=True, slots=True)
class Use:
    """The share of a bound that a run used; `measure` is the letter of the bound."""

    measure: str
    share: float | None
    """1 is the whole bound; None if the bound was crossed by an unknown amount."""
    is_crossed: bool
    text: str


@dataclass(frozen=True, slots=True)
class UseRow:
    """The used shares of one run, the largest first."""

    label: str
    file: str
    mark: Mark
    anchor: str
    section: str
    uses: tuple[Use, ...]


@dataclass(frozen=True, slots=True)
class Uses:
    """The runs of a requirement, ranked by the used share of its bounds."""

    title: str
    measures: tuple[tuple[str, str], ...]
    """(letter, name) of each bound."""
    rows: tuple[UseRow, ...]
    notes: tuple[str, ...]
    """Sentences about runs and bounds without a row."""
    text: str


@dataclass(frozen=True, slots=True)
class RequirementAcross:
    """The pictures of all runs of one requirement."""

    requirement: str
    anchor: str
    lanes: Lanes | None
    uses: Uses | None


@dataclass(frozen=True, slots=True)
class PlaceMark:
    """Position where nearby violations began; fields as in `LaneMark`."""

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
    """The path of the robot in one run, in metres, with the start of each violation."""

    anchor: str
    label: str
    file: str
    mark: Mark
    lines: tuple[tuple[tuple[float, float], ...], ...]
    marks: tuple[PlaceMark, ...]
    unplaced: int
    """Number of violations that began at an unknown position."""
    text: str


@dataclass(frozen=True, slots=True)
class Across:
    """The pictures over all runs, for all requirements together and for each."""

    lanes: Lanes | None
    requirements: tuple[RequirementAcross, ...]
    maps: tuple[RunMap, ...]
    """Maps of runs with a path, worst first."""
    maps_left_out: str
    """A sentence about runs without a map, or ""."""
