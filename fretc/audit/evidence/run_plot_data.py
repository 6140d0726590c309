"""Plot data of a run: the path of the robot; enumeration signals and what agents do, over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heapify, heappop, heappush
from itertools import count, pairwise
from math import ceil, floor, log10

import numpy as np
from numpy.typing import NDArray

from fretc.audit.evidence.schema import MOST_POINTS, MOST_WORDS, EnumChanges, RobotPath, RunPlotData
from fretc.logs.agents.word_signals import word_signals
from fretc.logs.signals.propositions import history_of
from fretc.logs.signals.samples import Gap, Numbers, Recording, Samples, Times
from fretish.bindings.declarations import Declarations, MapCoordinates, Signal
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity

_PAUSE = 10**9
"""Nanoseconds; positions farther apart in time are not joined, if no signal has an age limit."""
_HOLD = 10**8
"""Nanoseconds before the first and after the last sample for which its position is used."""
_FAR = 1e9
"""Metres; a coordinate beyond is treated as unknown."""
_DIGITS = 3
"""Decimals of a metre."""
_EXACT = 10.0**-_DIGITS
_MOST_LINES = MOST_POINTS // 3


def plot_data(recording: Recording, declarations: Declarations) -> RunPlotData | None:
    """The plot data of a run; None: there is nothing to draw."""
    words = {
        name: _words(signal, recording)
        for name, signal in sorted(declarations.signals.items())
        if signal.values and name in recording.samples
    }
    for name, samples in word_signals(recording.agents).items():
        words[name] = _shown(samples.times, samples.values.astype(np.int64), samples.words)
    way = _way(declarations.map, recording) if declarations.map else None
    return RunPlotData(way, words) if way or words else None


def map_diagnostics(recording: Recording, declarations: Declarations) -> Iterator[Diagnostic]:
    """F428 if the bindings declare a map and a coordinate is never known."""
    drawn = declarations.map
    for signal in (drawn.x, drawn.y) if drawn else ():
        samples = recording.beside.get(signal.name)
        if samples is None or not np.isfinite(samples.values.astype(np.float64)).any():
            yield Diagnostic(
                Code.NO_WAY,
                f"no map can be drawn: no value is known of `{signal.path}`",
                signal.span,
                "name a numeric field of a topic that a requirement reads",
                Severity.WARNING,
            )
            return


# Enumerations ----------------------------------------------------------------------------------


def _words(signal: Signal, recording: Recording) -> EnumChanges:
    """The changes of an enumeration signal, as propositions read it."""
    history = history_of({signal.name: signal}, recording)
    values, times = history.numbers[signal.name], history.times
    places = np.where(np.isnan(values), -1, values).astype(np.int64)
    last = np.append(times[1:] != times[:-1], True) if len(times) else np.zeros(0, bool)
    places, times = places[last], times[last]
    return _shown(times, places, signal.values)


def _shown(times: Times, places: NDArray[np.int64], words: Sequence[str]) -> EnumChanges:
    """The first changes of places in the words; negative places are unknown."""
    changed = np.append(True, places[1:] != places[:-1]) if len(places) else np.zeros(0, bool)
    places, times = places[changed], times[changed]
    return EnumChanges(
        tuple(times[:MOST_WORDS].tolist()),
        tuple(None if index < 0 else words[index] for index in places[:MOST_WORDS]),
        max(0, len(places) - MOST_WORDS),
    )


# The path --------------------------------------------------------------------------------------


def _way(drawn: MapCoordinates, recording: Recording) -> RobotPath | None:
    """The path as lines, thinned where this moves no position by much."""
    if not {drawn.x.name, drawn.y.name} <= recording.beside.keys():
        return None
    limit = min(signal.max_age or _PAUSE for signal in (drawn.x, drawn.y))
    x = recording.beside[drawn.x.name]
    times = x.times
    places = np.stack([x.base, _at(recording.beside[drawn.y.name], times, limit)], axis=1)
    is_known: NDArray[np.bool_] = np.asarray((np.abs(places) < _FAR).all(axis=1))
    lines = _lines(times, is_known, limit, recording.gaps)
    kept = sorted(sorted(lines, key=lambda line: line[0] - line[-1])[:_MOST_LINES], key=_first)
    if not kept:
        return None
    chosen, error = _thinned(times, places, kept, MOST_POINTS)
    points = [point for line in chosen for point in line]
    starts = np.cumsum([0, *map(len, chosen)])[:-1]
    return RobotPath(
        tuple(times[points].tolist()),
        tuple(np.round(places[points, 0], _DIGITS).tolist()),
        tuple(np.round(places[points, 1], _DIGITS).tolist()),
        tuple(starts.tolist()),
        _above(error + _EXACT),
        len(lines) - len(kept),
    )


_Line = NDArray[np.intp]
"""The samples of a line, by their indices."""


def _first(line: _Line) -> int:
    return int(line[0])


def _at(samples: Samples, times: Times, limit: int) -> Numbers:
    """The samples in force at some times; NaN: there is none, or it is too old."""
    if np.array_equal(samples.times, times):
        return samples.base
    last = np.searchsorted(samples.times, times, "right") - 1
    if not len(samples.times):
        return np.full(len(times), np.nan)
    values = samples.base[last]
    values[(last < 0) | (times - samples.times[last] > limit)] = np.nan
    return values


def _lines(times: Times, known: NDArray[np.bool_], limit: int, gaps: Sequence[Gap]) -> list[_Line]:
    """Ranges of known samples, with no pause between them and no loss."""
    (samples,) = np.nonzero(known)
    if not len(samples):
        return []
    own = times[samples]
    breaks = (np.diff(samples) > 1) | (np.diff(own) > limit)
    for start, end in gaps:
        breaks |= (own[:-1] <= end) & (own[1:] >= start)
    return np.split(samples, np.nonzero(breaks)[0] + 1)


def _thinned(
    times: Times, places: Numbers, lines: Sequence[_Line], most: int
) -> tuple[list[list[int]], float]:
    """The ends of each line, and the samples that are farthest from it, one after the other.

    Returns: /     The indices of the samples of each line, and the largest distance of an omitted
    sample from the line at its time.

    Returns:
        The samples of each line, and how far the farthest of the others is from where the line has
        the robot at its time.
    """
    chosen = [{int(line[0]), int(line[-1])} for line in lines]
    left = most - sum(map(len, chosen))
    number = count()
    heap = [_part(times, places, line, n, next(number)) for n, line in enumerate(lines)]
    heapify(heap)
    while left > 0 and heap and -heap[0][0] > _EXACT:
        _, _, of, at, line = heappop(heap)
        chosen[of].add(int(line[at]))
        left -= 1
        for part in (line[: at + 1], line[at:]):
            heappush(heap, _part(times, places, part, of, next(number)))
    return [sorted(each) for each in chosen], max((-one[0] for one in heap), default=0.0)


def _part(
    times: Times, places: Numbers, line: _Line, of: int, number: int
) -> tuple[float, int, int, int, _Line]:
    """A part of a line for the heap, which has the part with the largest distance first."""
    distance, at = _farthest(times, places, line)
    return -distance, number, of, at, line


def _farthest(times: Times, places: Numbers, line: _Line) -> tuple[float, int]:
    """The largest distance of a sample from the position on the line at its time, and its index."""
    if len(line) < 3:
        return 0.0, 0
    span = times[line[-1]] - times[line[0]]
    share = ((times[line] - times[line[0]]) / span if span else np.zeros(len(line)))[:, None]
    start, end = places[line[0]], places[line[-1]]
    distances = np.hypot(*(places[line] - (start + share * (end - start))).T)
    at = int(np.argmax(distances[1:-1])) + 1
    return float(distances[at]), at


def _above(number: float) -> float:
    """The number rounded up to two digits."""
    digits = 1 - floor(log10(number))
    return round(ceil(round(number * 10.0**digits, 6)) / 10.0**digits, digits)


def position_at(way: RobotPath, ns: int) -> tuple[float, float] | None:
    """The position of the robot at a time, within the error of the path; None: unknown.

    Up to `_HOLD` before the first and after the last sample it is where they are: ticks and samples
    begin and end at different times.
    """
    if not way.times_ns:
        return None
    begin, until = way.times_ns[0], way.times_ns[-1]
    if not way.lines_left_out and begin - _HOLD <= ns <= until + _HOLD:
        ns = min(max(ns, begin), until)
    for first, end in pairwise((*way.starts, len(way.times_ns))):
        times = way.times_ns[first:end]
        if times and times[0] <= ns <= times[-1]:
            own = np.array([time - times[0] for time in times], np.float64)
            at = float(ns - times[0])
            x, y = (np.interp(at, own, line[first:end]) for line in (way.x, way.y))
            return float(x), float(y)
    return None
