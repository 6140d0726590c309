"""Table of the verdicts of many runs: a row for each requirement, a column of symbols for each run.

The table is no wider than the screen. Rows and columns that do not fit are counted; the worst are
always shown.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from fretc.audit.evidence.verdicts import SHOWN
from fretc.audit.outputs.totals import COUNTED, VerdictWords, severity, sign_of
from fretc.terminal.output import Piece
from fretc.terminal.screen import Screen, fitted, padded, titled, width

MOST_RUNS = 200
"""Maximum number of columns; with more runs, the worst ones are shown."""
MOST_REQUIREMENTS = 60
"""Maximum number of rows; with more requirements, the worst ones are shown."""
MOST_NAMES = 20
"""Maximum number of runs that are named below the table."""
_GROUP = 10
"""Symbols between two blanks."""
_LONGEST_ID = 30
Line = tuple[Piece, ...]
_BLANK: Line = (("", None),)


def table(
    grid: VerdictWords, screen: Screen, titles: Mapping[str, str] = MappingProxyType({})
) -> Iterator[Line]:
    """The lines of the table, then the runs that are not satisfied.

    Args:
        grid: results of two runs or more.
        screen: the output screen.
        titles: titles of requirements by id; may lack some.
    """
    counts = [Counter(of_run.values()) for of_run in grid.words]
    badness = [*map(_badness, counts)]
    columns = sorted(sorted(range(len(grid.names)), key=badness.__getitem__)[:MOST_RUNS])
    worst_of = {id: severity(grid.word(id)) for id in grid.ids}
    worst_ids = sorted(grid.ids, key=worst_of.__getitem__)[:MOST_REQUIREMENTS]
    rows = [id for id in grid.ids if id in {*worst_ids}]
    yield from _blocks(grid, rows, columns, screen, titles)
    yield from _left_out(grid, rows, columns)
    bad = [run for run in columns if not {*counts[run]} <= {*SHOWN, COUNTED}]
    yield from _legend(grid, sorted(bad, key=badness.__getitem__), screen)


def _badness(counts: Counter[str]) -> tuple[tuple[int, int], ...]:
    """Sort key of runs: their verdicts, worst first, and how often they have each."""
    return tuple(sorted((severity(word), -count) for word, count in counts.items()))


def _blocks(
    grid: VerdictWords,
    rows: Sequence[str],
    columns: Sequence[int],
    screen: Screen,
    titles: Mapping[str, str],
) -> Iterator[Line]:
    """Blocks of columns that fit the screen, each with all rows."""
    most = min(screen.width // 3, _LONGEST_ID)
    names = [titled(screen.text(id), screen.text(titles.get(id, "")), most) for id in rows]
    room = max(map(width, (*names, "run")))
    names = [padded(name, room) for name in names]
    groups = max(1, (screen.width - room - 5) // (_GROUP + 1))
    for start in range(0, len(columns), groups * _GROUP):
        block = columns[start : start + groups * _GROUP]
        if start:
            yield _BLANK
        yield ((f"    {padded('run', room)} {_numbers(block)}".rstrip(), None),)
        for name, id in zip(names, rows, strict=True):
            sign = sign_of(grid.word(id))
            head: Line = ((f"  {sign.glyph} {name}", sign.colour),)
            yield (*head, *_marks(grid, id, block))


def _numbers(block: Sequence[int]) -> str:
    """Header line: the number of the first run of each group."""
    firsts = [f"{run + 1}" for run in block[::_GROUP]]
    return " ".join(padded(first, _GROUP) for first in firsts).rstrip()


def _marks(grid: VerdictWords, id: str, block: Sequence[int]) -> Iterator[Piece]:
    for index, run in enumerate(block):
        gap = " " if index % _GROUP == 0 else ""
        word = grid.words[run].get(id)
        sign = sign_of(word) if word else None
        yield (f"{gap}{sign.glyph}", sign.colour) if sign else (f"{gap} ", None)


def _left_out(grid: VerdictWords, rows: Sequence[str], columns: Sequence[int]) -> Iterator[Line]:
    """Line with the counts of rows and columns that are not shown."""
    kept_runs, kept_ids = {*columns}, {*rows}
    words = Counter(
        word
        for run, of_run in enumerate(grid.words)
        for id, word in of_run.items()
        if run not in kept_runs or id not in kept_ids
    )
    if not words:
        return
    parts = [
        f"{count:,} {what}"
        for count, what in (
            (len(grid.names) - len(columns), "runs"),
            (len(grid.ids) - len(rows), "requirements"),
        )
        if count
    ]
    yield _BLANK
    line = f"not in the table: {' and '.join(parts)} with {_counted(words)}; `-v` lists them"
    yield ((line, sign_of(min(words, key=severity)).colour),)


def _legend(grid: VerdictWords, bad: Sequence[int], screen: Screen) -> Iterator[Line]:
    """The names of the worst runs, and the number of further ones."""
    if bad:
        yield _BLANK
    for run in bad[:MOST_NAMES]:
        counts = Counter(grid.words[run].values())
        for word in (*SHOWN, COUNTED):
            counts.pop(word, None)
        head = f"  run {run + 1}: {_counted(counts)}: "
        name = screen.text(grid.names[run])
        room = screen.width - width(head)
        if room >= min(width(name), _LONGEST_ID):
            yield ((f"{head}{fitted(name, room)}", None),)
        else:
            yield ((fitted(head.rstrip(), screen.width), None),)
            yield ((f"    {fitted(name, screen.width - 4)}", None),)
    more = len(bad) - MOST_NAMES
    if more > 0:
        yield ((f"  and {more:,} more; `-v` lists them", None),)


def _counted(words: Counter[str]) -> str:
    return ", ".join(f"{words[word]:,} {word}" for word in sorted(words, key=severity))
