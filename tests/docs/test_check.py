"""What docs/check.md shows is what the command says and does."""

import re
from pathlib import Path

import pytest

from compiler.project.fixes import fixed_files
from fretish.diagnostics.source import Source
from fretish.parser import MOST_ERRORS, find_errors, parse
from fretish.syntax import Sentence
from tests.command import Fretc, write
from tests.each import each

DOCS = (Path(__file__).parents[2] / "docs/check.md").read_text("utf-8")
ROWS = [
    tuple(cell.strip().strip("`").replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:3])
    for line in DOCS.splitlines()
    if line.startswith("| `")
]
WRONG = "whenever p and q the rover should within 500 msec stopped\n"


def block(start: str) -> str:
    """The indented lines from the first one that begins so, without their indent."""
    lines = DOCS[DOCS.index(f"    {start}") :].splitlines()
    until = next(i for i, line in enumerate(lines) if not line.startswith("    "))
    return "".join(f"{line[4:]}\n" for line in lines[:until])


@each("row", ROWS)
def test_the_fixes_of_the_table_are_sure(
    row: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    written, meant = row
    (file,) = fixed_files([write("r.fret", written)])
    assert file.text == meant
    assert isinstance(parse(Source("r.fret", meant).span()), Sentence)


@pytest.mark.parametrize("text", ["p and q or r", "not p and q", "p until q", "3 < x < 5"])
def test_the_ones_that_are_not_sure_are_left_alone(text: str) -> None:
    found = find_errors(Source("r.fret", f"the sw shall satisfy {text}").span())
    assert found
    assert not any(each.fix and each.fix.is_safe for each in found)


def test_the_messages_are_printed(fretc: Fretc) -> None:
    write("requirements/r1.fret", WRONG)
    assert fretc("check").err.startswith(block("F101 `and`"))
    assert fretc("check", "--fix").err.startswith(block("wrote requirements"))


def test_as_many_mistakes_are_named_as_it_says() -> None:
    assert f"at most {MOST_ERRORS} mistakes" in DOCS
