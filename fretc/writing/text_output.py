"""Text output of `fretc write`: readings with their meaning, and runs as small tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from textwrap import wrap
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.text_output import drawn
from fretc.testing.words import RunColumns
from fretish.english.readings import Reading
from fretish.expressions import Comparison, Expression, names
from fretish.meaning import meaning

_WIDTH = 100
SCHEMA = "fretc-readings-1"


def in_words(requirement: FormalizedRequirement) -> str:
    """The meaning of a sentence in English."""
    return meaning(requirement.sentence, requirement.ticks, requirement.clock)


def listed(number: int, reading: Reading, words: str) -> Iterator[str]:
    """A reading with its number, its meaning, and what its names stand for."""
    head = f"{number}  "
    yield f"{head}{reading.text}"
    indent = " " * len(head)
    yield from wrap(words, _WIDTH, initial_indent=indent, subsequent_indent=indent)


def names_of(readings: Sequence[Reading]) -> Iterator[str]:
    """What the names of the readings stand for, and which words they lack."""
    said: dict[str, str] = {}
    lacking: dict[str, tuple[str, ...]] = {}
    for reading in readings:
        for name, words in reading.names.items():
            said.setdefault(name, words)
        lacking |= reading.lacking
    width = max(map(len, said), default=0)
    for name, words in said.items():
        missing = (
            f" (the name has no word for: {', '.join(lacking[name])})" if name in lacking else ""
        )
        yield f"{name:<{width}}  {words}{missing}"


def left_out(readings: Sequence[Reading]) -> tuple[str, ...]:
    """The words of the text that no reading contains, as runs."""
    return tuple(dict.fromkeys(words for reading in readings for words in reading.left_out))


def table(run: RunColumns, requirements: Sequence[FormalizedRequirement]) -> Iterator[str]:
    """A run as a table with a column for equal ticks; comparisons are shown by their numbers.

    Args:
        run: a run of all readings.
        requirements: the readings.
    """
    stated: dict[str, Expression] = {}
    wordings: dict[str, str] = {}
    for requirement in requirements:
        stated |= requirement.stated
        wordings |= requirement.wordings
    known = set.intersection(*({*row.values} for row in run.rows))
    hidden = {name for name in known if name in stated and _numbers(stated[name]) & known}
    play = [
        {wordings.get(n, n): value for n, value in row.values.items() if n not in hidden}
        for row in run.rows
        for _ in range(row.count)
    ]
    yield from drawn(play, {})


def _numbers(stated: Expression) -> set[str]:
    """The variables of a comparison."""
    return {name.id for name in names(stated)} if isinstance(stated, Comparison) else set()


def record(
    english: str,
    readings: Sequence[Reading],
    meanings: Sequence[str],
    questions: Sequence[Mapping[str, Any]],
    undecided: str,
) -> dict[str, Any]:
    """The readings of one English sentence as plain values for JSON."""
    return {
        "english": english,
        "readings": [
            {
                "sentence": reading.text,
                "meaning": words,
                "names": dict(reading.names),
                "lacking": {name: [*some] for name, some in reading.lacking.items()},
                "left_out": [*reading.left_out],
            }
            for reading, words in zip(readings, meanings, strict=True)
        ],
        "questions": [*questions],
        "undecided": undecided,
    }
