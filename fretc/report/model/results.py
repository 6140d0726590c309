"""Views of the results of a requirement: of each run, and of a probability over all runs."""

from __future__ import annotations

from fretc.report.model.marks import Mark
from fretc.report.model.pictures import Timeline
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Latency:
    """The latency of the response; `waits` are the longest waits, one for each answer."""

    answered: int
    at_once: int
    answers: str
    median: str
    longest: str
    longest_s: float
    is_bounded: bool
    bound: str
    waits: tuple[str, ...]
    median_s: float


@dataclass(frozen=True, slots=True)
class ViolationView:
    """An interval of violating ticks; `values` are `(signal, value)`."""

    start: str
    end: str
    """The end of the last violated tick; where the clock ticks by message, its beginning."""
    lasts: str
    """The duration; "" if the clock ticks by message."""
    ticks: str
    trigger: str
    deadline: str
    missing: str
    values: tuple[tuple[str, str], ...]
    causes: tuple[str, ...]
    """Why the response was wrong; empty if the evidence leaves that open."""


@dataclass(frozen=True, slots=True)
class ThresholdView:
    """A comparison with a constant, and the margin of the signal."""

    proposition: str
    comparison: str
    values: str
    margin: str
    nearest: str


@dataclass(frozen=True, slots=True)
class Listing:
    """The first of many lines, and their total number."""

    lines: tuple[str, ...]
    total: int


@dataclass(frozen=True, slots=True)
class ResultHead:
    """The run and the verdict of a result; it is suspect if `suspicions` is not empty."""

    anchor: str
    run: str
    """The anchor of the run."""
    run_label: str
    run_file: str
    mark: Mark
    suspicions: tuple[str, ...]
    reason: str
    triggers: int


@dataclass(frozen=True, slots=True)
class ResultRow(ResultHead):
    """The result of one run in numbers; `fretc.report.sections.details` reads its events."""

    place: int
    """Index of the result in the evidence, from 0."""
    number: int
    """Number of the result among the results of its requirement, from 1."""
    requirement: str
    section: str
    """The anchor of the requirement."""
    ticks: int
    answers: int
    at_once: int
    """Number of answers at the tick of their trigger."""
    open: int
    unknown: int
    """Number of intervals of unknown ticks."""
    violations_total: int
    latency_median_s: float | None
    latency_max_s: float | None

    @property
    def count(self) -> tuple[int, int, int]:
        """Numbers of violations, unknown intervals and open obligations."""
        return self.violations_total, self.unknown, self.open


@dataclass(frozen=True, slots=True)
class ResultView(ResultHead):
    """The result of one run with its events."""

    exercised: str
    latency: Latency | None
    """The latency of the answers; None if there is none."""
    unanswered: str
    """The triggers without an answer in time, and how late it was; "" if there is none."""
    thresholds: tuple[ThresholdView, ...]
    violations: tuple[ViolationView, ...]
    violations_total: int
    open: Listing
    unknown: Listing
    unknown_inputs: Listing
    """When inputs were unknown, of a result without a verdict."""
    timelines: tuple[Timeline, ...]


@dataclass(frozen=True, slots=True)
class BoundsView:
    """An interval of a probability; `name` is its method."""

    name: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ProbabilityView:
    """The estimate of a probability over all runs; `text` describes its picture."""

    mark: Mark
    suspicions: tuple[str, ...]
    """The reasons why the estimate is suspect."""
    stated: str
    bound: float
    reason: str
    lines: tuple[str, ...]
    estimate: float | None
    bars: tuple[BoundsView, ...]
    text: str
