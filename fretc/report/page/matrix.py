"""The matrix: a row for each requirement under each hazard, a column for each run.

Above `MOST` cells, the matrix has a cell for each hazard and group of runs, with the worst
mark and its count; the reader opens a part of it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby

from fretc.audit.evidence.verdicts import BROKEN, RETIRED
from fretc.report.model import phrases
from fretc.report.model.front import ColumnRun, RunGroup
from fretc.report.model.marks import Mark
from fretc.report.model.views import HazardRequirement, ReportView, RequirementView
from fretc.report.sections.matrix import FACTS
from fretish.classes.frozen import dataclass

MOST = 10_000
"""Maximum number of cells of a full matrix."""
TITLED = 2_000
"""Maximum number of cells with a tooltip that names requirement and run."""
_PART = 100
"""Maximum number of requirements, and of runs, per cell of the small matrix."""
_LISTED = 40
"""Maximum number of listed unsatisfied requirements per hazard."""


@dataclass(frozen=True, slots=True)
class MatrixCell:
    """The verdict of a requirement in a run; `anchor` is the anchor of its details."""

    mark: Mark
    anchor: str


@dataclass(frozen=True, slots=True)
class MatrixRow:
    """A row of the matrix; a cell is None if the run has no result for the requirement."""

    id: str
    row: HazardRequirement
    order: int
    words: str
    """The verdicts in the row, for the filter."""
    cells: tuple[MatrixCell | None, ...]


@dataclass(frozen=True, slots=True)
class CellTally:
    """A cell of the small matrix: number of cells by mark, worst first."""

    place: str
    """Range of requirements and of runs: `0.10.0.100` is (first, end) of both."""
    marks: tuple[tuple[Mark, int], ...]
    text: str
    """`12 violated, 488 satisfied`."""


@dataclass(frozen=True, slots=True)
class Unsatisfied:
    """A requirement that is not satisfied in some runs, in words, for the small matrix."""

    row: HazardRequirement
    text: str
    is_red: bool


@dataclass(frozen=True, slots=True)
class HazardRows:
    """The requirements of a hazard, worst first, or a part of them."""

    hazard: str
    title: str
    mark: Mark
    """The worst mark of its requirements."""
    summary: str
    """What the runs show of the requirements: a hazard itself has no verdict."""
    lines: tuple[MatrixRow, ...]
    tallies: tuple[CellTally, ...]
    unsatisfied: tuple[Unsatisfied, ...]
    left_out: str


@dataclass(frozen=True, slots=True)
class Picture:
    """The matrix for the page."""

    groups: tuple[RunGroup, ...]
    blocks: tuple[HazardRows, ...]
    is_small: bool
    """Whether the cells are of hazards and groups of runs."""
    is_titled: bool
    marks: tuple[Mark, ...]
    """All marks in the matrix, worst first."""
    facts: tuple[Mark, ...]
    """Marks of proofs and reviews in the matrix."""
    data: Mapping[str, object] | None
    """All cells for the script; None for a full matrix."""


def marks(view: RequirementView) -> dict[str, MatrixCell]:
    """Run → its cell, in the order of the runs.

    A run with several results has the worst mark.
    """
    cells: dict[str, MatrixCell] = {}
    for result in view.results:
        known = cells.get(result.run)
        if known is None or result.mark.severity < known.mark.severity:
            cells[result.run] = MatrixCell(result.mark, result.anchor)
    return cells


def picture(report: ReportView, anchors: Collection[str], most: int = MOST) -> Picture:
    """The matrix of a report.

    Args:
        report: the report with all results.
        anchors: anchors of results on the page; other cells link to their requirement.
        most: maximum number of cells of a full matrix.
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
    rows: Sequence[HazardRequirement],
    columns: Sequence[ColumnRun],
    known: Mapping[str, Mapping[str, MatrixCell]],
    anchors: Collection[str],
) -> list[MatrixRow]:
    """The rows, by hazard and worst first; the first row of a requirement has an id."""
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
            lines.append(MatrixRow(id, row, order[row.anchor], "|".join(words), cells))
    return lines


def _badness(row: HazardRequirement) -> tuple[tuple[int, bool], int]:
    return row.mark.severity, -row.runs if row.mark.word in BROKEN else 0


def _placed(
    cell: MatrixCell | None, row: HazardRequirement, anchors: Collection[str]
) -> MatrixCell | None:
    if cell is None or cell.anchor in anchors:
        return cell
    return MatrixCell(cell.mark, row.anchor)


def _blocks(lines: Sequence[MatrixRow]) -> Iterator[HazardRows]:
    for hazard, below in groupby(lines, key=lambda line: line.row.hazard):
        those = tuple(below)
        title, worst = those[0].row.hazard_title, _worst(those)
        yield HazardRows(hazard, title, worst, summary(those), those, (), (), "")


def summary(lines: Sequence[MatrixRow]) -> str:
    """`1 of 3 requirements is violated, 1 is not shown`.

    Args:
        lines: the requirements of a hazard, at least one.
    """
    marks = [line.row.mark for line in lines if line.row.mark.word != RETIRED]
    if not marks:
        return "no requirement in force"
    total = phrases.times(len(marks), "requirement")
    if all(mark.shows for mark in marks):
        holds = "the only requirement holds" if len(marks) == 1 else f"all {total} hold"
        return f"{holds} in these runs"
    broken = sum(mark.word in BROKEN for mark in marks)
    shown = sum(mark.shows for mark in marks)
    counts = ((broken, "violated"), (len(marks) - broken - shown, "not shown"))
    (first, what), *rest = ((count, word) for count, word in counts if count)
    text = f"{first} of {total} {_is(first)} {what}"
    return ", ".join([text, *(f"{count} {_is(count)} {word}" for count, word in rest)])


def _is(count: int) -> str:
    return "is" if count == 1 else "are"


def _worst(lines: Sequence[MatrixRow]) -> Mark:
    return min((line.row.mark for line in lines), key=lambda mark: mark.severity)


# The small picture -----------------------------------------------------------------------------


def _parts(groups: Sequence[RunGroup]) -> Iterator[RunGroup]:
    """The groups; groups with many runs are split."""
    for group in groups:
        runs = group.runs
        if len(runs) <= _PART:
            yield group
            continue
        for first in range(0, len(runs), _PART):
            part = runs[first : first + _PART]
            name = f"{group.name or 'runs'} {first + 1} to {first + len(part)}"
            yield RunGroup(name, part)


def _small(lines: Sequence[MatrixRow], groups: Sequence[RunGroup]) -> Iterator[HazardRows]:
    first = 0
    for block in _blocks(lines):
        for start in range(0, len(block.lines), _PART):
            part = block.lines[start : start + _PART]
            whole = len(part) == len(block.lines)
            title = block.title if whole else f"{block.title} ({start + 1} to {start + len(part)})"
            unsatisfied = [*_unsatisfied(part, groups)]
            kept = [each for n, each in enumerate(unsatisfied) if n < _LISTED or each.is_red]
            left = len(unsatisfied) - len(kept)
            yield HazardRows(
                block.hazard,
                title,
                _worst(part),
                summary(part),
                (),
                tuple(_tallies(part, first, groups)),
                tuple(kept),
                f"and {phrases.times(left, 'more requirement')}" if left > 0 else "",
            )
            first += len(part)


def _tallies(
    part: Sequence[MatrixRow], first: int, groups: Sequence[RunGroup]
) -> Iterator[CellTally]:
    start = 0
    for group in groups:
        end = start + len(group.runs)
        cells = (cell for line in part for cell in line.cells[start:end] if cell is not None)
        counts = Counter(cell.mark for cell in cells)
        ordered = sorted(counts.items(), key=lambda item: item[0].severity)
        text = ", ".join(f"{phrases.whole(count)} {mark.text}" for mark, count in ordered)
        yield CellTally(f"{first}.{first + len(part)}.{start}.{end}", tuple(ordered), text)
        start = end


def _unsatisfied(part: Sequence[MatrixRow], groups: Sequence[RunGroup]) -> Iterator[Unsatisfied]:
    """The numbers of unsatisfied runs of a requirement, by group, in words."""
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


def _among(mark: Mark, line: MatrixRow, groups: Sequence[RunGroup]) -> str:
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
    lines: Sequence[MatrixRow], columns: Sequence[ColumnRun], ordered: Sequence[Mark]
) -> dict[str, object]:
    """All cells, run-length encoded: a letter for each mark, and `-` for no result."""
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


def _run_lengths(cells: Sequence[MatrixCell | None], letters: Mapping[Mark, str]) -> str:
    """`a2b` for `aab`."""
    signs = ("-" if cell is None else letters[cell.mark] for cell in cells)
    lengths = ((sign, sum(1 for _ in same)) for sign, same in groupby(signs))
    return "".join(f"{sign}{length if length > 1 else ''}" for sign, length in lengths)
