"""Monitors in JavaScript."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.program.lowering import program as lowered
from compiler.program.program import Program, RequirementProgram, WindowMemory
from compiler.targets.javascript.monitor import text
from fretc.verification.compiled.plan import BuiltLibrary, ParsedSource, SourceText, implemented
from fretc.verification.compiled.tools import version
from fretc.verification.javascript.layout import check_layout
from fretc.verification.javascript.node import FLAGS, Module, placed

_IDS = re.compile(r'^[ \t]*\{ id: ("(?:[^"\\]|\\.)*"), sentence: ', re.MULTILINE)


def tool() -> str | None:
    """Path of Node, or None."""
    return shutil.which("node")


def checked(given: SourceText, requirements: Sequence[FormalizedRequirement]) -> ParsedSource:
    """The parsed layout of the text.

    Raises:
        UnexpectedLayoutError: the layout differs from that of fretc.
    """
    own_rules = implemented([json.loads(id) for id in _IDS.findall(given.text)], requirements)
    made = _program(own_rules)
    cells, ids = tuple(cell.name for cell in made.cells), tuple(each.id for each in own_rules)
    form = check_layout(given.text, text(*own_rules), cells, _windows(made), ids)
    return ParsedSource(own_rules, ids, form, cells, ())


def prepared(program: str, given: SourceText, checked: ParsedSource, folder: Path) -> BuiltLibrary:
    """The module.

    Raises:
        ToolError: Node cannot be run.
    """
    made = _program(checked.requirements)
    ages = {index: _ages(each) for index, each in enumerate(made.requirements)}
    placed(given.text, folder)
    module = Module(program, folder, checked.cells, _windows(made), ages)
    return BuiltLibrary(module, f"Node {version(program)} {' '.join(FLAGS)}", {})


def _program(requirements: Sequence[FormalizedRequirement]) -> Program:
    return lowered({requirement.id: requirement.watch for requirement in requirements})


def _windows(program: Program) -> dict[str, int]:
    """Window → maximum age of its values."""
    return {cell.name: cell.hi for cell in program.cells if isinstance(cell, WindowMemory)}


def _ages(requirement: RequirementProgram) -> tuple[str, ...]:
    """Marks whose age is read, to report a deadline."""
    if requirement.deadline_ticks is None:
        return ()
    return ("open", "last") if requirement.renewed else ("open",)
