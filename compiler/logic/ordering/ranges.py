"""Impossible combinations of comparisons of one term with constants or enumeration values.

The constants divide the line into cells, and the term lies in one of them. Two constants that are
not 32-bit floats may round to the same number: then a cell equals both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice
from operator import itemgetter

from compiler.logic.ordering import cells
from compiler.logic.ordering.relations import (
    ZERO,
    NumberTerm,
    Point,
    Relation,
    Term,
    is_word,
    of_magnitude,
)
from fretish import expressions as e

MOST = 10_000_000
"""Limit of cells times comparisons; further comparisons count as possible."""
MOST_STEPS = 5_000_000
"""Step limit of the search among cells, about a second."""
_TRUE: Mapping[e.ComparisonOperator, str] = {
    "<": "<", "<=": "<=", ">": ">", ">=": ">=", "=": "=", "!=": "<>",
}  # fmt: skip
"""The order of the left and the right side if the comparison is true."""
_TABLES = [
    str.maketrans({sign: str(int(sign in true)) for sign in "<=>"}) for true in _TRUE.values()
]


def is_of_one_term(relations: Mapping[str, Relation]) -> bool:
    """Whether all relations compare the same term with constants, or with enumeration values."""
    (left, *others) = dict.fromkeys(relation.left for relation in relations.values())
    if others or not isinstance(left, Term) or is_word(left):
        return False
    return all(isinstance(relation.right, NumberTerm) for relation in relations.values()) or (
        isinstance(left.text, e.Name)
        and all(
            is_word(relation.right) and relation.op in ("=", "!=")
            for relation in relations.values()
        )
    )


def exclusions(
    relations: Mapping[str, Relation], words: Mapping[str, Sequence[str]], share: Fraction
) -> Sequence[tuple[tuple[str, bool], ...]]:
    """The minimal sets of literals that are true in no cell.

    Args:
        relations: the comparisons of one term, by their names.
        words: the values of each enumerated signal.
        share: the part of the step limit that the search may use.
    """
    names = tuple(relations)
    while True:
        of_term = [relations[name] for name in names]
        most = int(MOST * share) // len(of_term)
        columns = tuple(islice(_columns(of_term, words), most + 1))
        if len(columns) <= most or len(names) == 1:
            break
        names = names[: len(names) // 2]
    combinations = cells.exclusions(columns, int(MOST_STEPS * share))
    return [
        tuple((names[place], value) for place, value in combination) for combination in combinations
    ]


def _columns(relations: Sequence[Relation], words: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """For each cell `1` or `0` for each comparison."""
    points, signs = _signs(relations, words)
    places = {point: index for index, point in enumerate(points)}
    rows = {op: row * len(points) for row, op in enumerate(_TRUE)}
    chosen = itemgetter(*(rows[relation.op] + places[relation.right] for relation in relations))
    for cell_signs in signs:
        yield "".join(chosen("".join(cell_signs.translate(table) for table in _TABLES)))


def _signs(
    relations: Sequence[Relation], words: Mapping[str, Sequence[str]]
) -> tuple[Sequence[Point], Iterator[str]]:
    """The points that the term is compared with; for each cell the term's order to each."""
    limits = {relation.right for relation in relations if isinstance(relation.right, NumberTerm)}
    term = relations[0].left
    assert isinstance(term, Term)
    if not limits:
        spoken = tuple(dict.fromkeys(relation.right for relation in relations))
        return spoken, _among(
            spoken, words.get(term.text.id, ()) if isinstance(term.text, e.Name) else ()
        )
    is_magnitude = of_magnitude(term) is not None
    row = sorted(limits | {ZERO} if is_magnitude else limits, key=lambda constant: constant.value)
    least = row.index(ZERO) if is_magnitude else None
    return row, (signs for signs in _on_line(row) if least is None or signs[least] != "<")


def _on_line(row: Sequence[NumberTerm]) -> Iterator[str]:
    """The cells between constants, and at each, with later ones that may be equal."""
    ends = [constant.ends for constant in row]
    for i in range(len(row) + 1):
        yield ">" * i + "<" * (len(row) - i)
        least = None
        for j in range(i, len(row)):
            if least is not None and least < ends[j][0]:
                break
            least = ends[j][1] if least is None else min(least, ends[j][1])
            yield ">" * i + "=" * (j + 1 - i) + "<" * (len(row) - j - 1)


def _among(spoken: Sequence[Point], words: Sequence[str]) -> Iterator[str]:
    """The cells of an enumerated term: one for each value, and one for other values."""
    for i in range(len(spoken)):
        yield "<" * i + "=" + "<" * (len(spoken) - i - 1)
    texts = {
        point.text.text
        for point in spoken
        if isinstance(point, Term) and isinstance(point.text, e.Word)
    }
    if not words or not texts.issuperset(words):
        yield "<" * len(spoken)
