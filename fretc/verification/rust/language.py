"""Monitors in Rust."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.rust.monitor import TARGET
from compiler.targets.target import TargetOptions
from fretc.verification.compiled.library import saved
from fretc.verification.compiled.plan import BuiltLibrary, ParsedSource, SourceText, implemented
from fretc.verification.rust.build import BASE, built, compiler
from fretc.verification.rust.layout import LEXIS, check_layout

_OUTCOMES = re.compile(r"^[ \t]+/// (.*)\n[ \t]+pub (\w+): Outcome,$", re.MULTILINE)
"""Fields of the struct of outcomes, and the ids in the comments above them."""

tool = compiler


def checked(given: SourceText, requirements: Sequence[FormalizedRequirement]) -> ParsedSource:
    """The parsed layout of the text.

    Raises:
        UnexpectedLayoutError: the layout differs from that of fretc.
    """
    own_rules = implemented([id for id, _ in _OUTCOMES.findall(given.text)], requirements)
    files = TARGET.emit(own_rules, TargetOptions(one_file=True))
    own = next(file.text for file in files if file.path.name == "lib.rs")
    cells, inputs = _fields(own, "struct Approximation"), _fields(own, "pub struct Inputs")
    outcomes = tuple(name for _, name in _OUTCOMES.findall(own))
    form = check_layout(given.text, own, cells, inputs, outcomes)
    is_original = LEXIS.tokens(given.text) == LEXIS.tokens(own)
    return ParsedSource(own_rules, outcomes, form, cells, inputs, is_original)


def prepared(program: str, given: SourceText, checked: ParsedSource, folder: Path) -> BuiltLibrary:
    """The built library; nothing of it has run.

    Raises:
        ToolError: the compiler rejects the text.
    """
    binary = built(program, given.text, checked.cells, checked.inputs, checked.outcomes)
    library, digest = saved(binary, folder, BASE, checked.cells)
    return BuiltLibrary(library, binary.engine, {f"{Path(given.name).stem}.so": digest})


def _fields(text: str, struct: str) -> tuple[str, ...]:
    body = text.partition(f"\n{struct} {{\n")[2].partition("\n}\n")[0]
    return tuple(re.findall(r"^    (?:pub )?(\w+): ", body, re.MULTILINE))
