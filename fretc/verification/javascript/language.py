"""Monitors in JavaScript."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import Formalized
from compiler.program.lowering import program as lowered
from compiler.program.program import Requirement, Window
from compiler.targets.javascript.monitor import text
from fretc.verification.compiled.plan import Checked, Given, Prepared, implemented
from fretc.verification.compiled.tools import version
from fretc.verification.javascript.form import formed
from fretc.verification.javascript.node import FLAGS, Module

_IDS = re.compile(r'^  \{ id: ("(?:[^"\\]|\\.)*"), sentence: ', re.MULTILINE)


def tool() -> str | None:
    """The path of Node, if it is installed."""
    return shutil.which("node")


def prepared(program: str, given: Given, rules: Sequence[Formalized], folder: Path) -> Prepared:
    """The module; nothing of it has run.

    Raises:
        StrangeTextError: the text is not in the form that fretc writes.
        ToolError: Node cannot be run.
    """
    own_rules = implemented([json.loads(id) for id in _IDS.findall(given.text)], rules)
    made = lowered({rule.id: rule.watch for rule in own_rules})
    cells = tuple(cell.name for cell in made.cells)
    windows = {cell.name: cell.hi for cell in made.cells if isinstance(cell, Window)}
    form = formed(given.text, text(*own_rules), cells, windows)
    places = tuple(map(str, range(len(own_rules))))
    ages = {place: _ages(each) for place, each in enumerate(made.requirements)}
    engine = f"Node {version(program)} {' '.join(FLAGS)}"
    module = Module(program, given.text, cells, windows, ages)
    return Prepared(Checked(own_rules, places, form, cells), module, engine, {})


def _ages(requirement: Requirement) -> tuple[str, ...]:
    """The marks whose age counts: those that a deadline is told by."""
    if requirement.horizon is None:
        return ()
    return ("open", "last") if requirement.renewed else ("open",)
