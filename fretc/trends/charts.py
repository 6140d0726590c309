"""The layout of trends: strips of rounds, and charts of numbers over rounds, at most 720 wide.

Each picture has a text with the same information: it never depends on colour alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import groupby
from statistics import median
from typing import Any

from fretc.report.model import phrases
from fretc.report.pictures.scales import RIGHT, WIDTH, Scale, frame, places, step
from fretc.trends.changes import RoundOutcome
from fretc.trends.comparisons import (
    ComparedMeasure,
    ComparisonFinding,
    Value,
    VersionComparison,
    amount,
)

_CELL, _TALL = 9, 16
MOST_CELLS = 60
"""The most rounds of a strip; it has the newest ones."""
_LEFT, _TOP, _BASE = 92, 14, 134
_MOST_DOTS = 40
"""The most dots of a round: the worst ones, and as many others as fit."""
_LABELS = 14
"""The approximate number of labelled rounds on the axis."""
_CELLS = {
    RoundOutcome.VIOLATED: ("violated", _TALL),
    RoundOutcome.SHOWN: ("shown", 7),
    RoundOutcome.OPEN: ("open", 12),
    None: ("absent", 1),
}
"""Outcome of a round → kind and height of its cell."""


def strip(round_outcomes: Sequence[RoundOutcome | None]) -> dict[str, Any]:
    """The newest rounds: a violated one is a tall bar, a shown one low, an open one hollow."""
    first = max(0, len(round_outcomes) - MOST_CELLS)
    shown = round_outcomes[first:]
    cells = []
    for place, outcome in enumerate(shown):
        kind, height = _CELLS[outcome]
        top = _TALL - height
        cells.append({"kind": kind, "x": place * _CELL + 1, "y": top, "height": height})
    size = {"width": _CELL * len(shown), "height": _TALL, "cell": _CELL - 2}
    return {**size, "cells": cells, "text": _in_words(shown, first + 1)}


def _in_words(round_outcomes: Sequence[RoundOutcome | None], first: int) -> str:
    """The rounds in words: `rounds 1 to 4 shown, 5 violated`."""
    parts, at = [], first
    for each, some in groupby(round_outcomes):
        last = at + len(list(some)) - 1
        which = f"{at}" if at == last else f"{at} to {last}"
        parts.append(f"{which} {'not judged' if each is None else _CELLS[each][0]}")
        at = last + 1
    return f"rounds {', '.join(parts)}"


# Numbers over rounds ----------------------------------------------------------------------------


def chart(one: VersionComparison, rounds: int, is_after: Sequence[bool], id: str) -> dict[str, Any]:
    """The numbers of all runs over the rounds, with the median of each round.

    Args:
        one: the comparison with the values of its runs.
        rounds: the number of rounds.
        is_after: for each run, whether it belongs to the newer side of the comparison.
        id: the id of the chart.
    """
    numbers = [value.number for value in one.values]
    low, high = min([0.0, *numbers]), max([0.0, *numbers])
    high = high if high > low else low + 1.0
    high = -(-high // (width := step((high - low) / 4))) * width
    x = Scale(0, rounds, _LEFT, WIDTH - RIGHT)
    y = Scale(low, high, _BASE, _TOP)
    of_round: dict[int, list[Value]] = defaultdict(list)
    for value in one.values:
        of_round[value.round].append(value)
    every = max(1, -(-rounds // _LABELS))
    return frame(
        id,
        f"{one.measure.ids}: {one.measure}",
        _text(one, of_round),
        x,
        _BASE + 38,
        base=_BASE,
        dots=[
            {"x": x(number + share), "y": y(value.number), "is_after": is_after[value.run]}
            for number, values in of_round.items()
            for share, value in _spread(_chosen(values, one.measure))
        ],
        medians=[
            (x(number + 0.15), x(number + 0.85), y(median(value.number for value in values)))
            for number, values in sorted(of_round.items())
        ],
        ticks=[(x(number + 0.5), str(number + 1)) for number in range(0, rounds, every)],
        marks=[
            (y(place), phrases.value(place, one.measure.unit)) for place in places(low, high, 4)
        ],
    )


def _chosen(values: Sequence[Value], measure: ComparedMeasure) -> Sequence[Value]:
    """The worst values and others in order: no worse value is left out for a better one."""
    if len(values) <= _MOST_DOTS:
        return values
    sign = 1 if measure.is_better_larger else -1
    worst = sorted(values, key=lambda value: sign * value.number)[: _MOST_DOTS // 2]
    rest = [value for value in values if value not in worst]
    return [*worst, *rest[:: max(1, len(rest) // (_MOST_DOTS // 2))]]


def _spread(values: Sequence[Value]) -> Iterator[tuple[float, Value]]:
    """Each value with its position in the column of its round, from 0 to 1."""
    for i, value in enumerate(values):
        yield 0.2 + 0.6 * (i + 0.5) / len(values), value


def _text(one: VersionComparison, of_round: dict[int, list[Value]]) -> str:
    unit = one.measure.unit
    ends = [
        f"round {number + 1} {amount(median(v.number for v in of_round[number]), unit)}"
        for number in dict.fromkeys((min(of_round), max(of_round)))
    ]
    medians = f"Median of {' and of '.join(ends)}"
    runs = phrases.times(len(one.values), "run")
    if one.finding is ComparisonFinding.REGRESSED:
        return f"Significantly worse, by medians: {one.worse}. {medians}; {runs} in all."
    return f"{medians}; {runs} in all: {one.finding}."
