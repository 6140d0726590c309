"""The files that targets make of a requirement, by name and hash."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from compiler.emit import TARGETS
from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.targets.interceptor_options import ASSUMED, assumed
from compiler.targets.python import interceptor
from compiler.targets.target import Options, Target
from fretish.bindings.declarations import Declarations


@dataclass(frozen=True, slots=True)
class Product:
    """A file that a target makes; where the target refuses, `sha256` is empty."""

    target: str
    file: str
    sha256: str
    refusal: str


_ALWAYS = ("monitor", "ltl", "ajpf", "json")


def products(rule: Formalized | None) -> tuple[Product, ...]:
    """A product for each file of the requirement, and for each target that refuses it.

    Other targets than `_ALWAYS` count only where `verify` of the requirement names them: all of
    them may take longer than the rest of the report.
    """
    if rule is None:
        return ()
    planned = [name for name in rule.requirement.verify if name in TARGETS]
    names = [name for name in dict.fromkeys((*_ALWAYS, *planned)) if TARGETS[name].per_rule]
    return tuple(product for name in names for product in _of_target(TARGETS[name], rule))


_LANGUAGES = {"_monitor.c": "c", "lib.rs": "rust", "_monitor.mjs": "js"}
"""How the names of monitors in other languages than Python end, and their target."""


def compiled_monitor(rule: Formalized, file: str) -> str:
    """SHA-256 of the monitor of the requirement alone that would be in such a file; or nothing.

    Args:
        rule: the requirement.
        file: its name.
    """
    for end, target in _LANGUAGES.items():
        if file.endswith(end):
            made = _of_target(TARGETS[target], rule)
            return next((one.sha256 for one in made if PurePath(one.file).name == file), "")
    return ""


_JOINT = {"monitors.py": "monitor", "monitors.c": "c", "lib.rs": "rust", "monitors.mjs": "js"}
"""The names of files with the monitor of many requirements, and their target."""


def joint_monitors(rules: Sequence[Formalized], files: Collection[str]) -> frozenset[str]:
    """SHA-256 of each file that has one monitor for all of the rules.

    Args:
        rules: all of a project, in its order; those that a target refuses are in no file.
        files: their names, among others.
    """
    found = set[str]()
    for file, target in _JOINT.items():
        accepted = [each for each in rules if TARGETS[target].refuse(each) is None]
        if file in files and accepted:
            made = TARGETS[target].emit(accepted, Options(one_file=True))
            found.add(next(sha256(each.text) for each in made if each.path.name == file))
    return frozenset(found)


def _of_target(target: Target, rule: Formalized) -> tuple[Product, ...]:
    refusal = target.refuse(rule)
    if refusal is not None:
        mend = f"; {refusal.help}" if refusal.help else ""
        text = f"{refusal.code.number} {refusal.message}{mend}"
        return (Product(target.name, "", "", text),)
    return tuple(
        Product(target.name, str(artifact.path), sha256(artifact.text), "")
        for artifact in target.emit([rule])
    )


def shared_products(declarations: Declarations | None) -> tuple[Product, ...]:
    """The products of the bindings alone: the interceptor, and its declared assumptions."""
    declared = declarations.interceptor if declarations else None
    if declarations is None or declared is None:
        return ()
    text = interceptor.text(declared, PurePath(declarations.source.name).name)
    node = Product(interceptor.TARGET.name, interceptor.NAME, sha256(text), "")
    return (node, Product("bindings", ASSUMED, assumed(declarations), ""))
