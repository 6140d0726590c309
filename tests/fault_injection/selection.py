"""Which test files stand near a module: its own, its folder's, and those of what imports it."""

from __future__ import annotations

import ast
from functools import cached_property
from pathlib import Path

from tests.fault_injection.drawing import ROOMS, TEMPLATES


class Neighbourhood:
    """The imports of a tree, product and tests, read once."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.tests = self._modules("tests")
        self.product = [path for room in ROOMS for path in self._modules(room)]

    def _modules(self, folder: str) -> list[str]:
        paths = sorted(self.root.joinpath(folder).rglob("*.py"))
        names = [path.relative_to(self.root).as_posix() for path in paths]
        return [name for name in names if "/golden/" not in name]

    @cached_property
    def imports(self) -> dict[str, set[str]]:
        """Each module of the tree, and the modules of the tree that it imports."""
        known = {*self.tests, *self.product}
        return {name: self._imported(name, known) for name in known}

    def _imported(self, name: str, known: set[str]) -> set[str]:
        names: set[str] = set()
        for node in ast.walk(ast.parse(self.root.joinpath(name).read_bytes())):
            if isinstance(node, ast.ImportFrom) and node.module:
                parts = node.module.replace(".", "/")
                names |= {f"{parts}.py", *(f"{parts}/{alias.name}.py" for alias in node.names)}
            elif isinstance(node, ast.Import):
                names |= {f"{alias.name.replace('.', '/')}.py" for alias in node.names}
        return names & known

    def _modules_with(self, path: str) -> set[str]:
        """Return the module itself, or those that name a template."""
        if not path.startswith(f"{TEMPLATES}/"):
            return {path}
        name = path.removeprefix(f"{TEMPLATES}/")
        named = {m for m in self.product if name in self.root.joinpath(m).read_text("utf-8")}
        folder = name.rpartition("/")[0] + "/"
        return named or {m for m in self.product if folder in self.root.joinpath(m).read_text("utf-8")}

    def _own(self, module: str) -> str:
        folder, _, name = module.rpartition("/")
        return f"tests/{folder}/test_{name}"

    def files(self, path: str) -> list[str]:
        """Return test files, the nearest first.

        The module's own; those that import it, straight or by a module of the tests; those of its
        folder; the own ones of modules that import it.
        """
        changed = self._modules_with(path)
        helpers = {t for t in self.tests if self.imports[t] & changed and not _is_test(t)}
        importers = sorted(m for m in self.product if self.imports[m] & changed)
        folders = {f"tests/{module.rpartition('/')[0]}" for module in changed}
        near = [
            *map(self._own, sorted(changed)),
            *(t for t in self.tests if self.imports[t] & changed),
            *(t for t in self.tests if t.rpartition("/")[0] in folders),
            *(t for t in self.tests if self.imports[t] & helpers),
            *map(self._own, importers),
            *(t for t in self.tests if self.imports[t] & {*importers}),
        ]
        known = {*self.tests}
        return [name for name in dict.fromkeys(near) if name in known and _is_test(name)]


def _is_test(name: str) -> bool:
    return name.rpartition("/")[2].startswith("test_")
