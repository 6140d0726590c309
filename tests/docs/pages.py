"""Pages of docs/ whose parts between two comments the code makes.

    <!-- picture: whenever p the robot shall within 2 ticks satisfy q -->
    what the code answers
    <!-- end -->

The answers are written anew by `pytest -n0 tests/docs --update-golden`; without it, a page that has
other ones is a failure. Those that take seconds are made with the full profile and then, only.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path

import pytest

from tests.effort import FULL

FOLDER = Path(__file__).parents[2] / "docs"
_PART = re.compile(
    r"^<!-- (?P<kind>\w+): (?P<subject>[^\n]*) -->\n.*?^<!-- end -->$", re.MULTILINE | re.DOTALL
)
Makers = Mapping[str, Callable[[str], str]]
"""Kind of a part → its text, by what the page asks for."""


def is_current(
    name: str, makers: Makers, request: pytest.FixtureRequest, costly: Collection[str] = ()
) -> None:
    """Compare the parts of a page with what the code makes of them, or rewrite them.

    Args:
        name: of the page.
        makers: of the parts.
        request: of the test.
        costly: the subjects of parts that are left as they are, but with the full profile.
    """
    path = FOLDER / name
    written = path.read_text(encoding="utf-8")
    updates = request.config.getoption("--update-golden")
    left = () if FULL or updates else costly
    assert {*costly} <= {part["subject"] for part in _PART.finditer(written)}
    made = _PART.sub(lambda p: p[0] if p["subject"] in left else _made(p, makers), written)
    if updates:
        path.write_text(made, encoding="utf-8")
        return
    assert written == made, f"docs/{name}: pytest -n0 tests/docs --update-golden"


def _made(part: re.Match[str], makers: Makers) -> str:
    kind, subject = part["kind"], part["subject"]
    return f"<!-- {kind}: {subject} -->\n{makers[kind](subject)}\n<!-- end -->"


def subjects(text: str, kind: str) -> list[str]:
    """What a page asks for, in its order."""
    return [part["subject"] for part in _PART.finditer(text) if part["kind"] == kind]


def blocks(text: str, language: str) -> list[str]:
    """The texts of the fenced blocks of one language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def rows(text: str) -> Iterator[tuple[str, ...]]:
    """The cells of each row of each table, without the line of its head."""
    lines = text.splitlines()
    for number, line in enumerate(lines):
        ruled = number + 1 < len(lines) and lines[number + 1].startswith("|--")
        if line.startswith("| ") and not ruled:
            cells = re.split(r"(?<!\\)\|", line.strip()[1:-1])
            yield tuple(cell.strip().replace("\\|", "|") for cell in cells)


def section(text: str, title: str) -> str:
    """What stands below a heading, up to the next one of its rank or above."""
    rank = title.partition(" ")[0]
    below = text.split(f"\n{title}\n", 1)[1]
    return re.split(rf"^#{{1,{len(rank)}}} ", below, maxsplit=1, flags=re.MULTILINE)[0]
