"""All texts that people read: pages, strings, docstrings, comments, templates, tables of codes."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("fretish", "monitors", "compiler", "fretc", "simulation", "benchmarks")
OTHERS = {
    "templates": (".j2", ".js", ".css", ".json"),
    "fretish": (".toml",),
    "requirements": (".fret",),
}


@dataclass(frozen=True)
class Passage:
    """A text that a person reads, and where it begins: path below the root, line from 1."""

    path: str
    line: int
    text: str


@cache
def passages() -> tuple[Passage, ...]:
    """Every passage of the project, in the order of the files."""
    return tuple(_passages())


def _passages() -> Iterator[Passage]:
    for page in pages():
        yield Passage(_name(page), 1, page.read_text(encoding="utf-8"))
    for package in PACKAGES:
        for module in sorted((ROOT / package).rglob("*.py")):
            yield from of_module(_name(module), module.read_text(encoding="utf-8"))
    for folder, endings in OTHERS.items():
        for file in sorted((ROOT / folder).rglob("*")):
            if file.suffix in endings:
                yield Passage(_name(file), 1, file.read_text(encoding="utf-8"))


def pages() -> list[Path]:
    """The pages of the documentation, but for the list of changes: that names former words."""
    found = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]
    return [page for page in found if page.name != "CHANGELOG.md"]


def of_module(path: str, text: str) -> Iterator[Passage]:
    """The strings and comments of a module of Python.

    A string whose parts stand in several places, or that has fields (`f"{x}"`), is one passage: a
    field is written as `{}`.
    """
    for node in _strings(ast.parse(text)):
        if isinstance(node, ast.JoinedStr):
            parts = (v.value if isinstance(v, ast.Constant) else "{}" for v in node.values)
            yield Passage(path, node.lineno, "".join(map(str, parts)))
        else:
            yield Passage(path, node.lineno, str(node.value))
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield Passage(path, token.start[0], token.string)


def _strings(node: ast.AST) -> Iterator[ast.Constant | ast.JoinedStr]:
    """The strings of a tree; of one with fields the whole, and the strings in its fields."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.JoinedStr):
            yield child
            for value in child.values:
                if isinstance(value, ast.FormattedValue):
                    yield from _strings(value)
        elif isinstance(child, ast.Constant) and isinstance(child.value, str):
            yield child
        else:
            yield from _strings(child)


def without_code(page: str) -> str:
    """The sentences of a page: no blocks of code, tables, headings or addresses."""
    page = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
    page = re.sub(r"^(    .*|\||#.*|\s*\|.*)$", "", page, flags=re.MULTILINE)
    page = re.sub(r"\]\([^)]*\)", "]", page)
    return re.sub(r"`[^`\n]*`", "name", page)


def _name(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()
