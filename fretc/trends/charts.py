"""The layout of trends: strips of rounds, and charts of numbers over rounds, at most 720 wide.

Each picture has a text with the same information: it never depends on colour alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from statistics import median

from fretc.report.model import phrases
from fretc.report.pictures.histograms import step
from fretc.report.pictures.plots import places
from fretc.trends.changes import RoundOutcome
from fretc.trends.comparisons import Comparison, Finding, Measure, Value, amount

_CELL, _TALL = 9, 16
MOST_CELLS = 60
"""The most rounds of a strip; it has the newest ones."""
_WIDTH, _LEFT, _RIGHT, _TOP, _BASE = 720, 92, 30, 14, 134
_MOST_DOTS = 40
"""The most dots of a round: the worst ones, and as many others as fit."""
_LABELS = 14
"""The approximate number of labelled rounds on the axis."""
_KINDS = {RoundOutcome.VIOLATED: "violated", RoundOutcome.SHOWN: "shown", RoundOutcome.OPEN: "open"}


@dataclass(frozen=True, slots=True)
class Cell:
    """A round of a strip."""

    kind: str
    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class Strip:
    """All rounds of a requirement in a scenario."""

    width: int
    height: int
    cells: tuple[Cell, ...]
    text: str


def strip(round_outcomes: Sequence[RoundOutcome | None]) -> Strip:
    """The newest rounds: a violated one is a tall bar, a shown one low, an open one hollow."""
    first = max(0, len(round_outcomes) - MOST_CELLS)
    shown = round_outcomes[first:]
    cells = tuple(_cell(i, each) for i, each in enumerate(shown))
    return Strip(_CELL * len(shown), _TALL, cells, _in_words(shown, first + 1))


def _cell(place: int, each: RoundOutcome | None) -> Cell:
    x, width = place * _CELL + 1, _CELL - 2
    match each:
        case RoundOutcome.VIOLATED:
            return Cell("violated", x, 0, width, _TALL)
        case RoundOutcome.SHOWN:
            return Cell("shown", x, _TALL - 7, width, 7)
        case RoundOutcome.OPEN:
            return Cell("open", x, _TALL - 12, width, 12)
        case None:
            return Cell("absent", x, _TALL - 1, width, 1)


def _in_words(round_outcomes: Sequence[RoundOutcome | None], first: int) -> str:
    """The rounds in words: `rounds 1 to 4 shown, 5 violated`."""
    parts, at = [], first
    for each, some in groupby(round_outcomes):
        last = at + len(list(some)) - 1
        which = f"{at}" if at == last else f"{at} to {last}"
        parts.append(f"{which} {'not judged' if each is None else _KINDS[each]}")
        at = last + 1
    return f"rounds {', '.join(parts)}"


# Numbers over rounds ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Dot:
    """The number of one run."""

    x: float
    y: float
    is_after: bool


@dataclass(frozen=True, slots=True)
class Chart:
    """The numbers of all runs over the rounds, with the median of each round."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: int
    top: int
    base: int
    dots: tuple[Dot, ...]
    medians: tuple[tuple[float, float, float], ...]
    """Left, right and height of each median."""
    ticks: tuple[tuple[float, str], ...]
    marks: tuple[tuple[float, str], ...]


def chart(one: Comparison, rounds: int, is_after: Sequence[bool], id: str) -> Chart:
    """The layout.

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
    column = (_WIDTH - _LEFT - _RIGHT) / rounds

    def y(number: float) -> float:
        return round(_BASE - (number - low) / (high - low) * (_BASE - _TOP), 1)

    of_round: dict[int, list[Value]] = defaultdict(list)
    for value in one.values:
        of_round[value.round].append(value)
    every = max(1, -(-rounds // _LABELS))
    return Chart(
        id=id,
        title=f"{one.measure.ids}: {one.measure}",
        text=_text(one, of_round),
        width=_WIDTH,
        height=_BASE + 38,
        left=_LEFT,
        right=_WIDTH - _RIGHT,
        top=_TOP,
        base=_BASE,
        dots=tuple(
            Dot(round(_LEFT + column * (number + share), 1), y(value.number), is_after[value.run])
            for number, values in of_round.items()
            for share, value in _spread(_chosen(values, one.measure))
        ),
        medians=tuple(
            (
                round(_LEFT + column * (number + 0.15), 1),
                round(_LEFT + column * (number + 0.85), 1),
                y(median(value.number for value in values)),
            )
            for number, values in sorted(of_round.items())
        ),
        ticks=tuple(
            (round(_LEFT + column * (number + 0.5), 1), str(number + 1))
            for number in range(0, rounds, every)
        ),
        marks=tuple(
            (y(place), phrases.value(place, one.measure.unit)) for place in places(low, high, 4)
        ),
    )


def _chosen(values: Sequence[Value], measure: Measure) -> Sequence[Value]:
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


def _text(one: Comparison, of_round: dict[int, list[Value]]) -> str:
    unit = one.measure.unit
    ends = [
        f"round {number + 1} {amount(median(v.number for v in of_round[number]), unit)}"
        for number in dict.fromkeys((min(of_round), max(of_round)))
    ]
    medians = f"Median of {' and of '.join(ends)}"
    runs = phrases.times(len(one.values), "run")
    if one.finding is Finding.REGRESSED:
        return f"Significantly worse, by medians: {one.worse}. {medians}; {runs} in all."
    return f"{medians}; {runs} in all: {one.finding}."
