"""Monitors in Java."""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.java.monitor import TARGET, java_printer
from compiler.targets.target import TargetOptions
from fretc.verification.compiled.plan import BuiltLibrary, ParsedSource, SourceText, implemented
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.tools import compile_in, version
from fretc.verification.java.layout import LEXIS, check_layout, package, without_package
from fretc.verification.java.machine import EXPLORER, EXPLORER_TEXT, JavaClass

FLAGS = ("--release", "11", "-encoding", "UTF-8", "-proc:none", "-implicit:none", "-nowarn")
_QUICK = ("-J-XX:TieredStopAtLevel=1", "-J-XX:+UseSerialGC")
"""Options of the compiler's own virtual machine, which runs for a moment."""
_OUTCOMES = re.compile(
    r"^[ \t]+// (.*)\n[ \t]+public final Outcome (\w+) = new Outcome\(\);$", re.MULTILINE
)
"""Fields of the class of outcomes, and the ids in the comments above them."""


def tool() -> str | None:
    """Path of javac, or None if it or `java` is missing."""
    return shutil.which("javac") if shutil.which("java") else None


def checked(given: SourceText, requirements: Sequence[FormalizedRequirement]) -> ParsedSource:
    """The parsed layout of the text.

    Raises:
        UnexpectedLayoutError: the layout differs from that of fretc.
    """
    own_rules = implemented([id for id, _ in _OUTCOMES.findall(given.text)], requirements)
    own, printer = _written(given.text, own_rules), java_printer(own_rules)
    variables = frozenset(printer.variables())
    cells = tuple(field.name for field in printer.fields() if field.name not in variables)
    inputs = tuple(printer.names.values())
    form = check_layout(given.text, own, cells, variables, inputs)
    outcomes = tuple(reading.prefix for reading in printer.program.readings)
    is_original = without_package(LEXIS.tokens(given.text)) == LEXIS.tokens(own)
    return ParsedSource(own_rules, outcomes, form, cells, inputs, is_original)


def prepared(program: str, given: SourceText, checked: ParsedSource, folder: Path) -> BuiltLibrary:
    """The compiled class; nothing of it has run.

    Raises:
        ToolError: the compiler rejects the text.
    """
    java = shutil.which("java")
    assert java is not None, "`tool` finds both"
    tokens = LEXIS.tokens(given.text)
    _, _, _, name, *_ = without_package(tokens)  # public final class NAME
    texts = {f"{name}.java": given.text, f"{EXPLORER}.java": EXPLORER_TEXT}
    steps = [(*_QUICK, "-classpath", "classes", "-d", "classes", *texts)]
    known = compile_in(folder, program, FLAGS, texts, steps)
    executable = JavaClass(
        java, folder, f"{package(tokens)}{name}", checked.cells, checked.inputs, checked.outcomes
    )
    return BuiltLibrary(executable, f"{known} {' '.join(FLAGS)}, {version(java)}", {})


def _written(text: str, requirements: Sequence[FormalizedRequirement]) -> str:
    """The text that fretc writes for these requirements, with the class name of the given one."""
    for one_file in (False, True) if len(requirements) == 1 else (True,):
        own, *_ = TARGET.emit(requirements, TargetOptions(one_file=one_file))
        if f"public final class {own.path.stem} {{" in text:
            return own.text
    raise UnexpectedLayoutError("its class has not the name that fretc gives it")
