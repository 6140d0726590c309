"""The samples around a violation, as an evidence file has them, in checked shapes.

Source: `templates/json/evidence.schema.json`, `window`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite
from typing import cast

from compiler.files.checked_json import Shape

_INFINITE = {"+inf": inf, "-inf": -inf}
_LARGEST = 2**63


@dataclass(frozen=True, slots=True)
class Samples:
    """Of one signal: each value holds from its time on; None: unknown."""

    times: tuple[float, ...]
    """Seconds from the first tick, not decreasing; before it negative."""
    values: tuple[float | None, ...]
    """In base units, of the same number; they may be infinite."""

    def at(self, seconds: float) -> float | None:
        """The value in force; None where it is unknown or there is none yet."""
        known = [v for t, v in zip(self.times, self.values, strict=True) if t <= seconds]
        return known[-1] if known else None


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of a run, in seconds from its first tick, with the samples of some signals."""

    start: float
    end: float
    samples: Mapping[str, Samples]


def window(at: Shape, first_ns: int) -> Window:
    """A window as it is written.

    Args:
        at: its object.
        first_ns: when the first tick of the run is, by the clock of the log.

    Raises:
        MisshapenError: it is none.
    """
    start, end = at.field("start_ns").whole(), at.field("end_ns").whole()
    if end < start:
        raise at.wrong("a stretch of time that ends after its start")
    samples = at.field("samples").fields()
    return Window(
        (start - first_ns) / 1e9,
        (end - first_ns) / 1e9,
        {name: _samples(each, first_ns) for name, each in samples.items()},
    )


def _samples(at: Shape, first_ns: int) -> Samples:
    times, values = _times(at.field("times_ns")), _values(at.field("values"))
    if len(times) != len(values):
        raise at.wrong("as many times as values")
    if any(late < early for early, late in pairwise(times)):
        raise at.field("times_ns").wrong("times in their order")
    return Samples(tuple([(ns - first_ns) / 1e9 for ns in times]), values)


def _times(at: Shape) -> list[int]:
    """All at once where they are right; one by one only to say which is not."""
    found = at.value
    if isinstance(found, list) and all(type(t) is int and abs(t) < _LARGEST for t in found):
        return found
    return [each.whole() for each in at.items()]


def _values(at: Shape) -> tuple[float | None, ...]:
    found = at.value
    if isinstance(found, list) and all(type(v) is float and isfinite(v) for v in found):
        return tuple(cast("list[float]", found))
    return tuple(each.or_none(_value) for each in at.items())


def _value(at: Shape) -> float:
    return _INFINITE[at.one_of(tuple(_INFINITE))] if isinstance(at.value, str) else at.number()
