"""The signals around a violation, as panels over its timeline."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import inf, isinf
from statistics import median
from types import MappingProxyType
from typing import TypeVar

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.samples import SignalSamples
from fretc.audit.evidence.schema import Result, ThresholdRecord, Violation
from fretc.report.model.pictures import Panel, SignalPiece, SpanMark, ThresholdLine, WordLane
from fretish import expressions as e
from fretish.bindings.amounts import exact, exact_duration
from fretish.printer import expression

MOST_PANELS = 4
"""Maximum number of signals in a picture; signals with a threshold come first."""
_COLUMNS = 240
"""The resolution of a panel: samples in one column are one stroke, least to greatest."""
_THINNED = 2.5
"""A gap between thinned samples is at least this many times their median distance."""
_SMALL = 0.04
"""A crossing of less than this share of the panel's height has an enlarged panel."""
_EMPTY = 1e-9
_FAR = 1e300
"""The end of every axis, so that its length is a finite 64-bit float."""

T = TypeVar("T", float, str)
Known = tuple[float, float, float | None]
"""(from, to, value in this interval or None)."""


def persistences(requirement: FormalizedRequirement | None) -> Mapping[tuple[str, str], str]:
    """(proposition, expression over signals) → ` for 500 ms`, from the bindings.

    Args:
        requirement: the requirement that was judged; None if unknown.
    """
    declared = requirement.declarations if requirement else None
    if declared is None:
        return {}
    return {
        (name, expression(side)): f" for {exact_duration(part.duration / 1e9)}"
        for name, proposition in declared.propositions.items()
        for part in e.parts(proposition.expression)
        if isinstance(part, e.Persistence)
        for compared in e.parts(part.arg)
        if isinstance(compared, e.Comparison)
        for side in (compared.left, compared.right)
    }


def panels(
    violation: Violation,
    result: Result,
    ages: Mapping[str, float],
    start: float,
    end: float,
    held: Mapping[tuple[str, str], str] = MappingProxyType({}),
) -> tuple[Panel, ...]:
    """A panel for each of the first signals of the window.

    A signal that crosses a bound by little has a second, enlarged panel.

    Args:
        violation: a violation without a window has no panel.
        result: of the run with the violation.
        ages: age limit of each signal in seconds; a signal without one has no limit.
        start: of the picture, in seconds from the first tick.
        end: of the picture.
        held: for how long a comparison must hold (`persistences`).
    """
    if violation.window is None:
        return ()
    bounds = {name: _bounds(name, result) for name in violation.window.samples}
    names = sorted(bounds, key=lambda name: not bounds[name])[:MOST_PANELS]
    return tuple(
        panel
        for name in names
        for stretches in [
            _stretches(
                violation.window.samples[name],
                ages.get(name, inf),
                start,
                end,
                violation.first.seconds,
            )
        ]
        for levels in [tuple(dict.fromkeys(_levels(name, bounds[name], held)))]
        for drawn in [_panel(name, result.units.get(name, ""), levels, stretches, start, end)]
        for panel in (drawn, *_enlarged(drawn, violation))
    )


def _enlarged(panel: Panel, violation: Violation) -> Iterator[Panel]:
    """The same panel around a bound that the signal crosses by too little to be seen."""
    first, last = violation.first.seconds, violation.last.seconds
    inside = [
        number
        for piece in panel.pieces
        for (begin, least, greatest), after in zip(
            piece.points, (*(point[0] for point in piece.points[1:]), piece.end), strict=True
        )
        if after > first and begin <= last
        for number in (least, greatest)
    ]
    outside = [number for piece in panel.pieces for _, *ends in piece.points for number in ends]
    for level in panel.levels:
        depths = [
            max(sign * (number - level.value) for number in inside)
            for sign in (1, -1)
            if inside and min(sign * (number - level.value) for number in outside) < 0
        ]
        depth = min((each for each in depths if each > 0), default=0.0)
        if 0 < depth < _SMALL * (panel.high - panel.low):
            low, high = level.value - 4 * depth, level.value + 4 * depth
            near = tuple(each for each in panel.levels if low <= each.value <= high)
            yield replace(panel, low=low, high=high, levels=near, is_enlarged=True)
            return


def word_lanes(
    violation: Violation, ages: Mapping[str, float], start: float, end: float
) -> tuple[WordLane, ...]:
    """A lane for each of the first signals of words of the window; arguments as of `panels`."""
    words = violation.window.words if violation.window else {}
    return tuple(
        WordLane(
            name,
            tuple((_short(a), _short(b), word) for a, b, word in _merged(stretches)),
        )
        for name, samples in list(words.items())[:MOST_PANELS]
        for stretches in [
            _stretches(samples, ages.get(name, inf), start, end, violation.first.seconds)
        ]
    )


def left_out(
    violation: Violation, drawn: Sequence[Panel], lanes: Sequence[WordLane] = ()
) -> tuple[str, ...]:
    """Signals of the window that have no panel, and no lane."""
    names = {*(panel.signal for panel in drawn), *(lane.signal for lane in lanes)}
    window = violation.window
    known = (*window.samples, *window.words) if window else ()
    return tuple(name for name in known if name not in names)


def _bounds(signal: str, result: Result) -> tuple[ThresholdRecord, ...]:
    """Thresholds on the signal itself, or on its absolute value, in its own unit."""
    unit = result.units.get(signal, "")
    return tuple(
        threshold
        for threshold in result.thresholds
        if threshold.signal in (signal, f"abs({signal})") and threshold.unit == unit
    )


def _levels(
    signal: str, bounds: Sequence[ThresholdRecord], held: Mapping[tuple[str, str], str]
) -> Iterator[ThresholdLine]:
    for bound in bounds:
        time = held.get((bound.proposition, bound.signal), "")
        label = f"{bound.operator} {exact(bound.bound, bound.unit)}{time}"
        if bound.signal == signal:
            yield ThresholdLine(bound.bound, label)
        else:
            yield ThresholdLine(bound.bound, f"|{signal}| {label}")
            yield ThresholdLine(-bound.bound, "")


# What is known when ----------------------------------------------------------------------------


def _stretches(
    samples: SignalSamples[T], age: float, start: float, end: float, broken: float
) -> list[tuple[float, float, T | None]]:
    """The time of the picture as intervals with one value, or None.

    Thinning keeps the last sample up to `broken`, so that sample ends at its age limit.
    """
    longest = _longest(samples, age)
    stretches: list[tuple[float, float, T | None]] = []
    following = (*samples.times[1:], inf)[: len(samples.times)]
    first = samples.times[0] if samples.times else end
    if first > start:
        stretches.append((start, min(first, end), None))
    for begin, after, value in zip(samples.times, following, samples.values, strict=True):
        is_stale = begin <= broken < after and round(broken - begin, 9) > age
        until = min(after, begin + (age if is_stale else longest))
        stretches.append((begin, until, value))
        if until < after:
            stretches.append((until, after, None))
    inside = ((max(a, start), min(b, end), v) for a, b, v in stretches)
    return [(a, b, v) for a, b, v in inside if b - a > _EMPTY or (b == a and v is not None)]


def _longest(samples: SignalSamples[T], age: float) -> float:
    """How long a sample holds; thinned samples hold longer, to bridge what thinning removed."""
    from fretc.audit.measurements.violations import EVEN_SAMPLES

    if len(samples.times) < EVEN_SAMPLES:
        return age
    usual = median(late - early for early, late in pairwise(samples.times))
    return max(age, _THINNED * usual)


def _panel(
    signal: str,
    unit: str,
    levels: tuple[ThresholdLine, ...],
    stretches: Sequence[Known],
    start: float,
    end: float,
) -> Panel:
    finite = [v for _, _, v in stretches if v is not None and not isinf(v)]
    low, high = _range([*finite, *(level.value for level in levels)])
    width = (end - start) / _COLUMNS
    return Panel(
        signal=signal,
        unit=unit,
        low=low,
        high=high,
        pieces=tuple(_pieces(stretches, width)),
        levels=levels,
        unknown=tuple(_unknown(stretches)),
        infinite=tuple(
            (_short(a), _short(b), "+inf" if v > 0 else "-inf")
            for a, b, v in _merged(stretches)
            if v is not None and isinf(v)
        ),
    )


def _range(values: Sequence[float]) -> tuple[float, float]:
    """From the least to the greatest value, with a margin; never empty."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    low, high = (min(max(end, -_FAR), _FAR) for end in (low, high))
    room = (high - low) * 0.08 or abs(high) * 0.1 or 1.0
    return low - room, high + room


def _merged(
    stretches: Sequence[tuple[float, float, T | None]],
) -> list[tuple[float, float, T | None]]:
    """The intervals, with neighbours of equal value merged."""
    merged: list[tuple[float, float, T | None]] = []
    for begin, end, value in stretches:
        if merged and merged[-1][2] == value and begin - merged[-1][1] <= _EMPTY:
            merged[-1] = (merged[-1][0], end, value)
        else:
            merged.append((begin, end, value))
    return merged


def _unknown(stretches: Sequence[Known]) -> Iterator[SpanMark]:
    for begin, end, value in _merged(stretches):
        if value is None:
            yield SpanMark(_short(begin), _short(end), 1)


def _pieces(stretches: Sequence[Known], width: float) -> Iterator[SignalPiece]:
    """An envelope with few points for each run of finite values."""
    run: list[tuple[float, float, float]] = []
    for begin, end, value in stretches:
        if value is None or isinf(value):
            if run:
                yield _piece(run, width)
            run = []
        else:
            run.append((begin, end, value))
    if run:
        yield _piece(run, width)


def _piece(run: Sequence[tuple[float, float, float]], width: float) -> SignalPiece:
    points: list[tuple[float, float, float]] = []
    for begin, end, value in run:
        if points and begin - points[-1][0] < width:
            at, least, greatest = points[-1]
            points[-1] = (at, min(least, value), max(greatest, value))
            if end - at > width:  # The last value holds beyond the column.
                points.append((_short(at + width), value, value))
        elif not points or points[-1][1:] != (value, value):
            points.append((_short(begin), value, value))
    return SignalPiece(tuple(points), _short(run[-1][1]))


def _short(seconds: float) -> float:
    return round(seconds, 6)
