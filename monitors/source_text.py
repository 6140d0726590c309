"""The source text of the run time that is copied into generated monitors and interceptors."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_ROOM = Path(__file__).parent
ALONE = """\
import sys

if __name__ == "__main__" and not getattr(sys.flags, "safe_path", False):
    del sys.path[0]  # files beside this one are not libraries
"""
"""The first statements of each generated file that can be run. Python would otherwise search its
folder for the standard library first. `from __future__ import annotations` would have to come
before these statements, so neither generated files nor the modules copied into them have it."""
_MODULES = ("verdicts", "columns", "listings", "stepping", "outcomes", "tables", "command")
"""The modules of `monitors.kernel`, each after the modules that it imports."""
_VARIABLES = ("readings", "variables", "variable_tables", "variable_command")
"""The additional modules of a monitor that is stepped by variables."""
_LIVE = (
    *("kernel/verdicts", "kernel/readings", "samples", "proposition_evaluator", "ticking"),
    *("perception", "stop_supervisor", "status_publisher"),
)
"""The modules that a live node needs in addition to its monitor."""
_FUNCTIONS = ("rounded_functions",)
"""The modules of the functions of computed signals."""
_MEMORY = ("memory",)
"""The modules of signals with memory."""
_FRAMES = ("transforms",)
"""The modules of signals of frames."""
_GOALS = ("goals",)
"""The modules of signals of actions."""


@dataclass(frozen=True, slots=True)
class Runtime:
    """Several modules joined into one text."""

    imports: str
    """The imports of the standard library, after the statements `ALONE`."""
    text: str


@cache
def kernel() -> Runtime:
    """The modules of the kernel, joined, with one block of imports."""
    return _joined(_ROOM / "kernel", _MODULES)


@cache
def kernel_of_variables() -> Runtime:
    """The kernel and the modules for variables; the text begins with the text of `kernel`."""
    return _joined(_ROOM / "kernel", (*_MODULES, *_VARIABLES))


@cache
def interceptor() -> Runtime:
    """The module `monitors/interceptor.py`."""
    return _joined(_ROOM, ("interceptor",))


@cache
def perception(
    *, rounds: bool = False, remembers: bool = False, frames: bool = False, goals: bool = False
) -> Runtime:
    """The modules that a live node needs in addition to its monitor.

    Args:
        rounds: whether it calls the functions of computed signals.
        remembers: whether it has signals with memory.
        frames: whether it has signals of frames.
        goals: whether it has signals of actions.
    """
    optional = ((rounds, _FUNCTIONS), (remembers, _MEMORY), (frames, _FRAMES), (goals, _GOALS))
    modules = (module for wanted, some in optional if wanted for module in some)
    return _joined(_ROOM, (*_LIVE, *modules))


def _joined(folder: Path, modules: Sequence[str]) -> Runtime:
    imports: dict[str, set[str]] = {}
    texts: list[str] = []
    for module in modules:
        source = folder.joinpath(f"{module}.py").read_text(encoding="utf-8")
        last = _collect(ast.parse(_beginning(source)), imports)
        texts.append("\n".join(source.splitlines()[last:]).strip())
    return Runtime(_head(imports), "\n\n\n".join(texts))


_CODE = re.compile(r"^(?!import |from |[ )]|$)", re.MULTILINE)
"""The start of a line that is neither an import nor empty."""


def _beginning(source: str) -> str:
    """The docstring and imports of a module; parsing all modules completely would take 15 ms."""
    code = _CODE.search(source, source.index('"""', 3) + 3)
    return source[: code.start()] if code else source


def _collect(tree: ast.Module, imports: dict[str, set[str]]) -> int:
    """Add a module's imports of the standard library; the last line of its imports."""
    last = 0
    for node in tree.body:
        if isinstance(node, ast.Import):
            imports.update({alias.name: set() for alias in node.names})
        elif isinstance(node, ast.ImportFrom):
            if node.module not in ("__future__", None) and not str(node.module).startswith(
                "monitors"
            ):
                imports.setdefault(f"from {node.module}", set()).update(a.name for a in node.names)
        elif not (isinstance(node, ast.Expr) and node is tree.body[0]):
            break
        assert node.end_lineno is not None
        last = node.end_lineno
    return last


def _head(imports: dict[str, set[str]]) -> str:
    plain = [f"import {name}" for name in sorted(imports) if name != "sys" and " " not in name]
    some = [
        _from(name, sorted(names, key=lambda own: (not own.isupper(), own)))
        for name, names in sorted(imports.items())
        if name.startswith("from ")
    ]
    return "\n".join([ALONE, *plain, *some])


def _from(module: str, names: list[str]) -> str:
    line = f"{module} import {', '.join(names)}"
    if len(line) <= 88:
        return line
    return "\n".join([f"{module} import (", *(f"    {name}," for name in names), ")"])
