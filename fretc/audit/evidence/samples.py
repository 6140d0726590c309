"""The samples around a violation: in the form of an evidence file, and in seconds of the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from itertools import pairwise
from math import inf
from typing import Annotated, Generic, Literal, TypeVar

from compiler.files.records import UNSET, Meta, Number, Record, UnsetType, Whole, about
from fretish.classes.frozen import dataclass

_INFINITE = {"+inf": inf, "-inf": -inf}
_FEW = Meta(max_length=50)

Word = Annotated[str, Meta(min_length=1, max_length=100)]
"""An enumeration value."""
Reading = Annotated[
    Number | Literal["+inf", "-inf"] | None,
    about("values in base units; +inf: nothing in range, -inf: too near to measure, null: unknown"),
]


class WindowSamples(Record, frozen=True):
    """The sample of a signal in force at the start of a window, and those after it.

    Of more than 50 samples, some are kept: among them the least, the greatest, and the one in force
    at the first violated tick.
    """

    times_ns: Annotated[tuple[Whole, ...], _FEW]
    values: Annotated[tuple[Reading, ...], _FEW]

    def __post_init__(self) -> None:
        """Raise ValueError if times and values do not form a series."""
        check_series(self.times_ns, self.values)


def check_series(times: Sequence[int], values: Sequence[object]) -> None:
    """Raise ValueError if times and values do not form a series."""
    if len(times) != len(values):
        raise ValueError("Expected as many times as values")
    if any(late < early for early, late in pairwise(times)):
        raise ValueError("Expected times in their order")


class WordSeries(Record, frozen=True):
    """The samples of an enumeration signal in a window."""

    times_ns: Annotated[tuple[Whole, ...], _FEW]
    words: Annotated[tuple[Word | None, ...], _FEW]

    def __post_init__(self) -> None:
        """Raise ValueError if times and values do not form a series."""
        check_series(self.times_ns, self.words)


class Surroundings(Record, frozen=True):
    """The signals from 2 s before the trigger of a deadline to 2 s after the deadline.

    Without a deadline, they are those around tick `first`.
    """

    start_ns: Whole
    end_ns: Whole
    samples: dict[str, WindowSamples]
    words: Annotated[
        dict[str, WordSeries] | UnsetType,
        about(
            "the values of enumeration signals; what each agent believes, pursues and did last; "
            "absent: there are none"
        ),
    ] = UNSET

    def __post_init__(self) -> None:
        """Raise ValueError if the window ends before its start."""
        if self.end_ns < self.start_ns:
            raise ValueError("Expected a stretch of time that ends after its start")


T = TypeVar("T", float, str)


@dataclass(frozen=True, slots=True)
class SignalSamples(Generic[T]):
    """The samples of one signal: each value holds from its time on; None: unknown."""

    times: tuple[float, ...]
    """Seconds from the first tick, not decreasing; negative before the first tick."""
    values: tuple[T | None, ...]
    """As many as times; numbers may be infinite."""

    def at(self, seconds: float) -> T | None:
        """The value in force at a time; None: it is unknown, or there is none yet."""
        values = [v for t, v in zip(self.times, self.values, strict=True) if t <= seconds]
        return values[-1] if values else None


@dataclass(frozen=True, slots=True)
class RunPart:
    """A part of a run, in seconds from its first tick, with the samples of some signals."""

    start: float
    end: float
    samples: Mapping[str, SignalSamples[float]]
    words: Mapping[str, SignalSamples[str]] = field(default_factory=dict)
    """The samples of enumeration signals."""


def window(surroundings: Surroundings, first_ns: int) -> RunPart:
    """The samples around a violation, in seconds of the run, by the names of the signals.

    Args:
        surroundings: the window of a violation.
        first_ns: the time of the first tick of the run, on the clock of the log.
    """
    return RunPart(
        (surroundings.start_ns - first_ns) / 1e9,
        (surroundings.end_ns - first_ns) / 1e9,
        {
            name: SignalSamples(_seconds(each.times_ns, first_ns), tuple(map(number, each.values)))
            for name, each in sorted(surroundings.samples.items())
        },
        {
            name: SignalSamples(_seconds(each.times_ns, first_ns), each.words)
            for name, each in sorted((surroundings.words or {}).items())
        },
    )


def _seconds(times: Sequence[int], first_ns: int) -> tuple[float, ...]:
    return tuple([(ns - first_ns) / 1e9 for ns in times])


def number(reading: float | str | None) -> float | None:
    """A reading as a number, which may be infinite."""
    return _INFINITE[reading] if isinstance(reading, str) else reading
