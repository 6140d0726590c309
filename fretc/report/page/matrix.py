"""The matrix as a picture: a row for each requirement under each hazard, a column for each run.

Above `MOST` cells the picture is of hazards and groups of runs, with the worst mark of each and
its count; the reader opens a part of it. `marks` is where verdicts come from, for both.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from fretc.audit.evidence.verdicts import BROKEN
from fretc.report.model import phrases
from fretc.report.model.front import ColumnRun, RunGroup
from fretc.report.model.views import Mark, Report, RequirementView, Row
from fretc.report.sections.matrix import FACTS

MOST = 10_000
"""The most cells of a picture that has all of them."""
TITLED = 2_000
"""The most cells that say their requirement and run in a title of their own."""
_PART = 100
"""The most requirements, and the most runs, that share a cell of the small picture's axis."""
_LISTED = 40
"""The most lines of what is not satisfied, of one hazard."""


@dataclass(frozen=True, slots=True)
class Cell:
    """The verdict of a requirement in a run; `anchor` leads to its details."""

    mark: Mark
    anchor: str


@dataclass(frozen=True, slots=True)
class Line:
    """A row of the picture; None where a run has no result of the requirement."""

    id: str
    row: Row
    order: int
    words: str
    """The verdicts that are in it, for the filter."""
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True, slots=True)
class Tally:
    """A cell of the small picture: how many cells of each mark it stands for, the worst first."""

    place: str
    """Which requirements and runs: `0.10.0.100`, first and end of both."""
    marks: tuple[tuple[Mark, int], ...]
    text: str
    """`12 violated, 488 satisfied`."""


@dataclass(frozen=True, slots=True)
class Unsatisfied:
    """What is not satisfied of a requirement, in words, where the picture is small."""

    row: Row
    text: str
    is_red: bool


@dataclass(frozen=True, slots=True)
class Block:
    """The requirements of a hazard, the worst first, or a part of them."""

    hazard: str
    title: str
    mark: Mark
    lines: tuple[Line, ...]
    tallies: tuple[Tally, ...]
    unsatisfied: tuple[Unsatisfied, ...]
    left_out: str


@dataclass(frozen=True, slots=True)
class Picture:
    """The matrix for the page."""

    groups: tuple[RunGroup, ...]
    blocks: tuple[Block, ...]
    is_small: bool
    """Whether it is of hazards and groups."""
    is_titled: bool
    marks: tuple[Mark, ...]
    """All marks in it, the worst first."""
    facts: tuple[Mark, ...]
    """What is known of requirements beside their verdicts: proofs and reviews."""
    data: Mapping[str, object] | None
    """All cells for the script, where the picture is small."""


def marks(view: RequirementView) -> dict[str, Cell]:
    """The mark of each run with its place, in the order of the runs.

    One run has one mark: of several results the worst.
    """
    cells: dict[str, Cell] = {}
    for result in view.results:
        known = cells.get(result.run)
        if known is None or result.mark.severity < known.mark.severity:
            cells[result.run] = Cell(result.mark, result.anchor)
    return cells


def picture(report: Report, anchors: Collection[str], most: int = MOST) -> Picture:
    """The picture of a report.

    Args:
        report: with all results.
        anchors: of the results that have a place of their own in the page; the cells of others
            lead to their requirement.
        most: the most cells of a picture that has all of them.
    """
    columns = [run for group in report.front.groups for run in group.runs]
    cells = len(report.matrix) * len(columns)
    known = {view.anchor: marks(view) for view in report.requirements}
    found = {cell.mark for line in known.values() for cell in line.values()}
    ordered = tuple(sorted(found, key=lambda mark: mark.severity))
    small = cells > most
    groups = tuple(_parts(report.front.groups)) if small else report.front.groups
    lines = _lines(report.matrix, columns, known, anchors)
    return Picture(
        groups=groups,
        blocks=tuple(_small(lines, groups) if small else _blocks(lines)),
        is_small=small,
        is_titled=cells <= TITLED,
        marks=ordered,
        facts=FACTS,
        data=_data(lines, columns, ordered) if small else None,
    )


def _lines(
    rows: Sequence[Row],
    columns: Sequence[ColumnRun],
    known: Mapping[str, Mapping[str, Cell]],
    anchors: Collection[str],
) -> list[Line]:
    """Each row with its cells: by hazard, the worst first; the first of a requirement has an id."""
    lines = []
    seen = set[str]()
    order = {row.anchor: number for number, row in reversed([*enumerate(rows)])}
    for _, below in groupby(rows, key=lambda row: row.hazard):
        for row in sorted(below, key=_badness):
            own = known[row.anchor]
            cells = tuple(_placed(own.get(run.anchor), row, anchors) for run in columns)
            words = dict.fromkeys([row.mark.text, *(c.mark.text for c in cells if c)])
            id = "" if row.anchor in seen else f"row-{row.anchor.removeprefix('req-')}"
            seen.add(row.anchor)
            lines.append(Line(id, row, order[row.anchor], "|".join(words), cells))
    return lines


def _badness(row: Row) -> tuple[tuple[int, bool], int]:
    return row.mark.severity, -row.runs if row.mark.word in BROKEN else 0


def _placed(cell: Cell | None, row: Row, anchors: Collection[str]) -> Cell | None:
    if cell is None or cell.anchor in anchors:
        return cell
    return Cell(cell.mark, row.anchor)


def _blocks(lines: Sequence[Line]) -> Iterator[Block]:
    for hazard, below in groupby(lines, key=lambda line: line.row.hazard):
        those = tuple(below)
        title, worst = those[0].row.hazard_title, _worst(those)
        yield Block(hazard, title, worst, those, (), (), "")


def _worst(lines: Sequence[Line]) -> Mark:
    return min((line.row.mark for line in lines), key=lambda mark: mark.severity)


# The small picture -----------------------------------------------------------------------------


def _parts(groups: Sequence[RunGroup]) -> Iterator[RunGroup]:
    """The groups, those with many runs in parts."""
    for group in groups:
        runs = group.runs
        if len(runs) <= _PART:
            yield group
            continue
        for first in range(0, len(runs), _PART):
            part = runs[first : first + _PART]
            name = f"{group.name or 'runs'} {first + 1} to {first + len(part)}"
            yield RunGroup(name, part)


def _small(lines: Sequence[Line], groups: Sequence[RunGroup]) -> Iterator[Block]:
    first = 0
    for block in _blocks(lines):
        for start in range(0, len(block.lines), _PART):
            part = block.lines[start : start + _PART]
            whole = len(part) == len(block.lines)
            title = block.title if whole else f"{block.title} ({start + 1} to {start + len(part)})"
            unsatisfied = [*_unsatisfied(part, groups)]
            kept = [each for n, each in enumerate(unsatisfied) if n < _LISTED or each.is_red]
            left = len(unsatisfied) - len(kept)
            yield Block(
                block.hazard,
                title,
                _worst(part),
                (),
                tuple(_tallies(part, first, groups)),
                tuple(kept),
                f"and {phrases.times(left, 'more requirement')}" if left > 0 else "",
            )
            first += len(part)


def _tallies(part: Sequence[Line], first: int, groups: Sequence[RunGroup]) -> Iterator[Tally]:
    start = 0
    for group in groups:
        end = start + len(group.runs)
        cells = (cell for line in part for cell in line.cells[start:end] if cell is not None)
        counts = Counter(cell.mark for cell in cells)
        ordered = sorted(counts.items(), key=lambda item: item[0].severity)
        text = ", ".join(f"{phrases.whole(count)} {mark.text}" for mark, count in ordered)
        yield Tally(f"{first}.{first + len(part)}.{start}.{end}", tuple(ordered), text)
        start = end


def _unsatisfied(part: Sequence[Line], groups: Sequence[RunGroup]) -> Iterator[Unsatisfied]:
    """In how many runs of which groups a requirement is not satisfied."""
    for line in part:
        open_ = Counter(cell.mark for cell in line.cells if cell and not cell.mark.shows)
        ordered = sorted(open_.items(), key=lambda item: item[0].severity)
        texts = [
            f"{mark.text} in {phrases.times(count, 'run')}{_among(mark, line, groups)}"
            for mark, count in ordered
        ]
        if texts or not line.row.mark.shows:
            red = any(mark.word in BROKEN for mark in (line.row.mark, *open_))
            yield Unsatisfied(line.row, "; ".join(texts) or line.row.mark.text, red)


def _among(mark: Mark, line: Line, groups: Sequence[RunGroup]) -> str:
    """` (safety-off 10, walker 2)`: the groups of violations."""
    if mark.word not in BROKEN:
        return ""
    counts, start = [], 0
    for group in groups:
        end = start + len(group.runs)
        if count := sum(cell is not None and cell.mark == mark for cell in line.cells[start:end]):
            counts.append(f"{group.name} {count}")
        start = end
    return f" ({phrases.some(counts, 4)})"


_LETTERS = "abcdefghijklmnopqrstuvwxyz"


def _data(
    lines: Sequence[Line], columns: Sequence[ColumnRun], ordered: Sequence[Mark]
) -> dict[str, object]:
    """All cells: a letter for each mark, and how often it is repeated; `-` where there is none."""
    letters = {mark: _LETTERS[number] for number, mark in enumerate(ordered)}
    return {
        "runs": [[run.name, run.short, run.anchor] for run in columns],
        "marks": {letters[mark]: [mark.glyph, mark.text] for mark in ordered},
        "rows": [
            [
                line.row.requirement,
                line.row.title,
                line.row.anchor,
                f"{line.row.mark.glyph} {line.row.runs or ''}".rstrip(),
                line.row.mark.text,
                _run_lengths(line.cells, letters),
                {
                    str(column): cell.anchor
                    for column, cell in enumerate(line.cells)
                    if cell is not None and cell.anchor != line.row.anchor
                },
            ]
            for line in lines
        ],
    }


def _run_lengths(cells: Sequence[Cell | None], letters: Mapping[Mark, str]) -> str:
    """`a2b` for `aab`."""
    signs = ("-" if cell is None else letters[cell.mark] for cell in cells)
    lengths = ((sign, sum(1 for _ in same)) for sign, same in groupby(signs))
    return "".join(f"{sign}{length if length > 1 else ''}" for sign, length in lengths)
