"""No module imports itself by way of others, not for its types and not within a function either."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation")


def name_of(module: Path) -> str:
    return ".".join(module.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


MODULES = {name_of(path): path for room in ROOMS for path in (ROOT / room).rglob("*.py")}


def imported(text: str) -> set[str]:
    """The modules of ours that a text imports, wherever in it: `from a import b` may name a.b."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in MODULES else node.module for name in names}
    return found & MODULES.keys()


@pytest.mark.slow
def test_no_module_imports_itself() -> None:
    graph = {name: imported(path.read_text(encoding="utf-8")) for name, path in MODULES.items()}
    TopologicalSorter(graph).prepare()


def test_a_cycle_is_found_within_functions_and_for_types() -> None:
    texts = {
        "fretish.clock": "def f():\n    from fretish import parser\n",
        "fretish.parser": "if TYPE_CHECKING:\n    from fretish.clock import Clock\n",
    }
    graph = {name: imported(text) for name, text in texts.items()}
    with pytest.raises(CycleError):
        TopologicalSorter(graph).prepare()
