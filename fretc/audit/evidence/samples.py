"""The samples around a violation: as an evidence file has them, and in seconds of the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Annotated, Literal

from compiler.files.records import Meta, Number, Record, Whole, about

_INFINITE = {"+inf": inf, "-inf": -inf}
_FEW = Meta(max_length=50)

Reading = Annotated[
    Number | Literal["+inf", "-inf"] | None,
    about("in base units; +inf: nothing in range, -inf: too near to measure, null: unknown"),
]


class Series(Record, frozen=True):
    """The sample of a signal in force at the start of a window, and those after it.

    Of more than 50 some, with the least, the greatest and the last one at the first violated tick.
    """

    times_ns: Annotated[tuple[Whole, ...], _FEW]
    values: Annotated[tuple[Reading, ...], _FEW]

    def __post_init__(self) -> None:
        """Raise ValueError where it is no series."""
        if len(self.times_ns) != len(self.values):
            raise ValueError("Expected as many times as values")
        if any(late < early for early, late in pairwise(self.times_ns)):
            raise ValueError("Expected times in their order")


class Surroundings(Record, frozen=True):
    """The signals from 1 s before the trigger to 1 s after the deadline, or around tick `first`."""

    start_ns: Whole
    end_ns: Whole
    samples: dict[str, Series]

    def __post_init__(self) -> None:
        """Raise ValueError where it ends before its start."""
        if self.end_ns < self.start_ns:
            raise ValueError("Expected a stretch of time that ends after its start")


@dataclass(frozen=True, slots=True)
class Samples:
    """Of one signal: each value holds from its time on; None: unknown."""

    times: tuple[float, ...]
    """Seconds from the first tick, not decreasing; before it negative."""
    values: tuple[float | None, ...]
    """Of the same number; they may be infinite."""

    def at(self, seconds: float) -> float | None:
        """The value in force; None where it is unknown or there is none yet."""
        values = [v for t, v in zip(self.times, self.values, strict=True) if t <= seconds]
        return values[-1] if values else None


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of a run, in seconds from its first tick, with the samples of some signals."""

    start: float
    end: float
    samples: Mapping[str, Samples]


def window(surroundings: Surroundings, first_ns: int) -> Window:
    """The same in seconds, signals by their names.

    Args:
        surroundings: of a violation.
        first_ns: when the first tick of the run is, by the clock of the log.
    """
    return Window(
        (surroundings.start_ns - first_ns) / 1e9,
        (surroundings.end_ns - first_ns) / 1e9,
        {name: _samples(each, first_ns) for name, each in sorted(surroundings.samples.items())},
    )


def _samples(series: Series, first_ns: int) -> Samples:
    times = tuple([(ns - first_ns) / 1e9 for ns in series.times_ns])
    return Samples(times, tuple(map(number, series.values)))


def number(reading: float | str | None) -> float | None:
    """A reading as a number, which may be infinite."""
    return _INFINITE[reading] if isinstance(reading, str) else reading
