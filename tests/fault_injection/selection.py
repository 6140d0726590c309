"""Which test files stand near a module: its own, those that import it, its users', its folder's."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path

from tests.fault_injection.drawing import ROOMS, TEMPLATES

DOTTED = re.compile(r"(?:\w+\.)+\w*")
"""A module that is imported by its name, or `a.b.`, of which each module may be."""
ENOUGH = 12
"""So many test files are looked for among the users of users."""


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
        return {name: self._imported(name) & known for name in known}

    def _imported(self, name: str) -> set[str]:
        names: set[str] = set()
        for node in ast.walk(ast.parse(self.root.joinpath(name).read_bytes())):
            if isinstance(node, ast.ImportFrom) and node.module:
                names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
            elif isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.Constant) and DOTTED.fullmatch(str(node.value)):
                names.add(str(node.value))
        paths = {name.replace(".", "/") for name in names}
        folders = tuple(path for path in paths if path.endswith("/"))
        return {
            *(f"{path}.py" for path in paths),
            *(f"{path}/__init__.py" for path in paths),
            *(module for module in self.product if folders and module.startswith(folders)),
        }

    def _changed(self, path: str) -> set[str]:
        """Return the module itself, or those that name a template or else its folder."""
        if not path.startswith(f"{TEMPLATES}/"):
            return {path}
        name = path.removeprefix(f"{TEMPLATES}/")
        return self._naming(name) or self._naming(name.rpartition("/")[0] + "/")

    def _naming(self, text: str) -> set[str]:
        modules = self.product
        return {m for m in modules if text in self.root.joinpath(m).read_text("utf-8")}

    def _importing(self, modules: set[str], names: Iterable[str]) -> list[str]:
        return [name for name in names if self.imports[name] & modules]

    def files(self, path: str) -> tuple[list[str], list[str]]:
        """Return the module's own test files, and then the others near it, the nearest first.

        The others import it, straight or by a helper of the tests; are the own ones of modules that
        use it; stand beside its own; import those modules; and so on outwards until they are
        enough.
        """
        changed = self._changed(path)
        helpers = {name for name in self._importing(changed, self.tests) if not _is_test(name)}
        users = set(self._importing(changed, self.product)) - changed
        folders = {f"tests/{module.rpartition('/')[0]}" for module in changed}
        own = self._tests(map(_own, sorted(changed)))
        near = [
            *self._importing(changed, self.tests),
            *self._importing(helpers, self.tests),
            *map(_own, sorted(users)),
            *(name for name in self.tests if name.rpartition("/")[0] in folders),
        ]
        reached = {*changed}
        while users:
            near += [*map(_own, sorted(users)), *self._importing(users, self.tests)]
            if len(self._tests(near)) >= ENOUGH:
                break
            reached |= users
            users = set(self._importing(users, self.product)) - reached
        return own, [name for name in self._tests(near) if name not in own]

    def _tests(self, names: Iterable[str]) -> list[str]:
        known = {*self.tests}
        return [name for name in dict.fromkeys(names) if name in known and _is_test(name)]


def _own(module: str) -> str:
    folder, _, name = module.rpartition("/")
    return f"tests/{folder}/test_{name}"


def _is_test(name: str) -> bool:
    return name.rpartition("/")[2].startswith("test_")
