"""The layout of trends: strips of rounds, and charts of numbers over rounds, at most 720 wide.

Each picture has a text with the same information: it never depends on colour alone.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import PurePosixPath
from statistics import median
from types import MappingProxyType
from typing import Any
from urllib.parse import quote

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
from fretc.trends.histories import Round
from fretc.trends.known_requirements import NOTHING_KNOWN, KnownRequirements
from fretc.trends.trends import Item, Trends
from fretish.diagnostics import status_symbols as signs
from fretish.documents import named
from fretish.reading.natural_order import natural

_CELL, _TALL = 9, 16
MOST_CELLS = 60
"""The most rounds of a strip; it has the newest ones."""
_LEFT, _TOP = 92, 4
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
    for index, outcome in enumerate(shown):
        kind, height = _CELLS[outcome]
        top = _TALL - height
        cells.append({"kind": kind, "x": index * _CELL + 1, "y": top, "height": height})
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


# All requirements over rounds --------------------------------------------------------------------

_GLYPHS = {
    RoundOutcome.VIOLATED: signs.BAD,
    RoundOutcome.OPEN: signs.UNKNOWN,
    RoundOutcome.SHOWN: signs.GOOD,
}
MOST_COLUMNS = 31
"""The most rounds of a heat map; it has the newest ones."""
MOST_ROWS = 200
"""The most requirements of a heat map; it has the worst ones."""


def heat_map(
    trends: Trends, address: str = "", titles: Mapping[str, str] = MappingProxyType({})
) -> dict[str, Any]:
    """A row for each requirement, the worst first, and a column for each round.

    A cell has the worst outcome of its scenarios.

    Args:
        trends: the trends.
        address: of the report of a round, with `{name}` for the name of its evidence; "" without.
        titles: id of a requirement → its title.
    """
    first = max(0, len(trends.rounds) - MOST_COLUMNS)
    rows: dict[str, list[Item]] = defaultdict(list)
    for item in trends.items:
        rows[item.requirement].append(item)
    reports = [_address(address, each) for each in trends.rounds[first:]]
    return {
        "columns": [
            {"name": each.days or each.name, "report": report, "title": each.name}
            for each, report in zip(trends.rounds[first:], reports, strict=True)
        ],
        "rows": [
            {
                "id": id,
                "title": titles.get(id, ""),
                "sentence": trends.sentences.get(id, ""),
                "cells": [
                    _heat(id, each.days or each.name, [i.round_outcomes[number] for i in items], to)
                    for number, (each, to) in enumerate(
                        zip(trends.rounds[first:], reports, strict=True), first
                    )
                ],
            }
            for id, items in [*rows.items()][:MOST_ROWS]
        ],
        "left": max(0, len(rows) - MOST_ROWS),
        "older": first,
    }


def _heat(
    id: str, when: str, outcomes: Sequence[RoundOutcome | None], report: str
) -> dict[str, Any]:
    """The worst of some outcomes, with the number of violated scenarios."""
    known = [outcome for outcome in _GLYPHS if outcome in outcomes]
    if not known:
        return {"kind": "", "glyph": "", "text": f"{id} on {when}: not judged", "report": ""}
    bad = outcomes.count(RoundOutcome.VIOLATED)
    among = f" in {phrases.times(bad, 'scenario')}" if bad else ""
    sign = _GLYPHS[known[0]]
    return {
        "kind": sign.kind,
        "glyph": f"{sign.glyph}{bad if bad > 1 else ''}",
        "text": f"{id} on {when}: {known[0]}{among}",
        "report": f"{report}#req-{quote(id)}" if report else "",
    }


def _address(address: str, each: Round) -> str:
    """The address of the report of a round."""
    return address.replace("{name}", quote(PurePosixPath(each.name).stem)) if address else ""


# Numbers over rounds ----------------------------------------------------------------------------

_PANEL = 84
"""The height of the panel of a scenario."""
_MOST_PANELS = 8
"""The most scenarios with a panel; the others share the last one."""


def chart(
    one: VersionComparison,
    rounds: Sequence[str],
    is_after: Sequence[bool],
    id: str,
    known: KnownRequirements = NOTHING_KNOWN,
) -> dict[str, Any]:
    """The numbers of all runs over the rounds, with a panel for each scenario.

    Args:
        one: the comparison with the values of its runs.
        rounds: the names of the rounds on the axis.
        is_after: for each run, whether it belongs to the newer side of the comparison.
        id: the id of the chart.
        known: titles and time limits of the requirements.
    """
    bound = _bound(one.measure, known)
    numbers = [*(value.number for value in one.values), *([] if bound is None else [bound])]
    low, high = min([0.0, *numbers]), max([0.0, *numbers])
    high = high if high > low else low + 1.0
    high = -(-high // (width := step((high - low) / 3))) * width
    x = Scale(0, len(rounds), _LEFT, WIDTH - RIGHT)
    of_round: dict[int, list[Value]] = defaultdict(list)
    panels: dict[str, list[Value]] = defaultdict(list)
    scenarios = sorted({str(value.scenario) for value in one.values}, key=natural)
    for value in sorted(one.values, key=lambda value: scenarios.index(str(value.scenario))):
        of_round[value.round].append(value)
        index = scenarios.index(str(value.scenario))
        fits = index < _MOST_PANELS - 1 or len(scenarios) <= _MOST_PANELS
        panels[str(value.scenario) if fits else "other scenarios"].append(value)
    every = max(1, -(-len(rounds) // _LABELS))
    base = _TOP + _PANEL * len(panels)
    return frame(
        id,
        f"{_named(one.measure, known)}: {one.measure}",
        _text(one, of_round, bound),
        x,
        base + 46,
        base=base,
        worse=f"worse {'↓' if one.measure.is_better_larger else '↑'}",
        panels=[
            _panel(
                name, values, bound, one, is_after, x, Scale(low, high, top + _PANEL - 8, top + 20)
            )
            for number, (name, values) in enumerate(panels.items())
            for top in [_TOP + _PANEL * number]
        ],
        ticks=[(x(number + 0.5), rounds[number]) for number in range(0, len(rounds), every)],
    )


def _panel(
    name: str,
    values: Sequence[Value],
    bound: float | None,
    one: VersionComparison,
    is_after: Sequence[bool],
    x: Scale,
    y: Scale,
) -> dict[str, Any]:
    """The numbers of one scenario, with their bound if it is known."""
    of_round: dict[int, list[Value]] = defaultdict(list)
    for value in values:
        of_round[value.round].append(value)
    return {
        "name": name,
        "y": y.end - 6,
        "dots": [
            {"x": x(number + share), "y": y(value.number), "is_after": is_after[value.run]}
            for number, some in of_round.items()
            for share, value in _spread(_chosen(some, one.measure))
        ],
        "medians": [
            (x(number + 0.15), x(number + 0.85), y(median(value.number for value in some)))
            for number, some in sorted(of_round.items())
        ],
        "bound": None if bound is None else y(bound),
        "marks": [
            (y(mark), phrases.value(mark, one.measure.unit)) for mark in places(y.first, y.last, 3)
        ],
    }


def _bound(measure: ComparedMeasure, known: KnownRequirements) -> float | None:
    """The bound of a number: 0 of a margin, the allowed time of a latency; None: unknown."""
    return 0.0 if measure.is_better_larger else known.limits.get(measure.ids)


def _named(measure: ComparedMeasure, known: KnownRequirements) -> str:
    """The title and id of one requirement, or the ids of several."""
    return named(measure.ids, known.titles.get(measure.ids, ""))


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


def _text(one: VersionComparison, of_round: dict[int, list[Value]], bound: float | None) -> str:
    unit = one.measure.unit
    ends = [
        f"{amount(median(v.number for v in of_round[number]), unit)} in round {number + 1}"
        for number in dict.fromkeys((min(of_round), max(of_round)))
    ]
    medians = f"Median {' and '.join(ends)}"
    medians += f"; allowed {amount(bound, unit)}" if bound else ""
    runs = phrases.times(len(one.values), "run")
    if one.finding is ComparisonFinding.REGRESSED:
        return f"Significantly worse, by medians: {one.worse}. {medians}; {runs} in all."
    return f"{medians}; {runs} in all: {one.finding}."
