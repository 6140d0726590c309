"""The traces of docs/fret-differences.md really tell the two readings apart."""

import re
from pathlib import Path

import pytest

from compiler.formalization.formalize import formalize
from compiler.logic.definition import holds
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.parser import parse
from tests.fret_notation import parse as parse_notation
from tests.fret_notation import values

TEXT = (Path(__file__).parent.parent.parent / "docs/fret-differences.md").read_text("utf-8")


def rows(heading: str, cells: int) -> list[tuple[str, ...]]:
    """The cells of the table below a heading, without back-ticks and escapes."""
    section = TEXT.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in section.splitlines() if line.startswith("|")][2:]
    found = [
        tuple(cell.strip().strip("`").replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line))
        for line in lines
    ]
    assert all(len(row) == cells + 2 for row in found)
    return [row[1:-1] for row in found]


def columns_of(trace: str) -> dict[str, str]:
    return {name: digits for name, _, digits in (part.partition("=") for part in trace.split())}


def verdict(sentence: str, trace: str) -> bool:
    """Ours, at the end of the trace."""
    columns = columns_of(trace)
    length = len(next(iter(columns.values())))
    points = [{name: digits[t] == "1" for name, digits in columns.items()} for t in range(length)]
    ((entry,), _) = requirements(Source("r.fret", sentence))
    requirement, said = formalize(entry, None)
    assert requirement is not None, said
    return holds(requirement.pt, points, length - 1)


@pytest.mark.parametrize(
    ("why", "sentence", "fret", "trace", "ours", "theirs"),
    rows("The same sentence, another formula", 6),
)
def test_the_trace_has_the_verdicts_that_the_table_gives(
    why: str, sentence: str, fret: str, trace: str, ours: str, theirs: str
) -> None:
    columns = columns_of(trace)
    length = len(next(iter(columns.values())))
    word = {name: [int(digit) for digit in digits] for name, digits in columns.items()}
    theirs_at_end = bool(values(parse_notation(fret), word, length)[-1])
    assert (verdict(sentence, trace), theirs_at_end) == (ours == "true", theirs == "true"), why


@pytest.mark.parametrize(
    ("sentence", "trace", "ours"),
    [
        *rows("The same sentence, and no formula in FRET", 3),
        *rows("The same sentence, grouped in two ways by FRET", 3),
    ],
)
def test_the_sentence_says_of_the_trace_what_the_table_says(
    sentence: str, trace: str, ours: str
) -> None:
    assert verdict(sentence, trace) is (ours == "true")


@pytest.mark.parametrize(("sentence", "fret", "code"), rows("Refused here, accepted by FRET", 3))
def test_a_misread_sentence_is_refused(sentence: str, fret: str, code: str) -> None:
    refused = parse(Source("r.fret", sentence).span())
    assert isinstance(refused, Diagnostic)
    assert refused.code.number == code


@pytest.mark.parametrize(("sentence", "fret", "reading"), rows("Accepted here, refused by FRET", 3))
def test_a_clear_sentence_is_read_as_it_says(sentence: str, fret: str, reading: str) -> None:
    spelt_out = parse(Source("r.fret", reading).span())
    assert not isinstance(spelt_out, Diagnostic)
    assert parse(Source("r.fret", sentence).span()) == spelt_out
