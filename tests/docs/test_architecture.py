"""ARCHITECTURE.md names functions by their files: each is there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation")
MODULES = [path for room in ROOMS for path in (ROOT / room).rglob("*.py")]
NAMED = re.compile(r"`(\w+)`\s\(`([\w/]+\.py)`")
"""`load` (`compiler/project/folder.py`): a path may be cut off on its left."""


def defined(module: Path) -> set[str]:
    """The functions, classes and variables that a module defines."""
    nodes = [*ast.walk(ast.parse(module.read_text(encoding="utf-8")))]
    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return stored | {n.name for n in nodes if isinstance(n, ast.FunctionDef | ast.ClassDef)}


@pytest.mark.slow
def test_each_name_is_in_its_file() -> None:
    named = NAMED.findall((ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8"))
    assert len(named) > 30
    wrong = [
        f"`{name}` (`{path}`)"
        for name, path in named
        if not any(name in defined(m) for m in MODULES if m.as_posix().endswith(f"/{path}"))
    ]
    assert wrong == []
