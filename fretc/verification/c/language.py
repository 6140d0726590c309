"""Monitors in C."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import TargetOptions
from fretc.verification.c.build import built, compiler, layout
from fretc.verification.c.layout import LEXIS, check_layout
from fretc.verification.compiled.library import saved
from fretc.verification.compiled.plan import BuiltLibrary, ParsedSource, SourceText, implemented
from fretc.verification.compiled.text import UnexpectedLayoutError, same

_OUTCOMES = re.compile(r"^    fretc_outcome (\w+); /\* (.*) \*/$", re.MULTILINE)
"""Members of the struct of outcomes, and the ids in their comments."""

tool = compiler


def checked(given: SourceText, requirements: Sequence[FormalizedRequirement]) -> ParsedSource:
    """The parsed layout of the texts.

    Args:
        given: the texts.
        requirements: requirements that they may implement.

    Raises:
        UnexpectedLayoutError: the layout differs from that of fretc.
    """
    own_rules = implemented([id for _, id in _OUTCOMES.findall(given.header)], requirements)
    own, own_header = _written(given, own_rules)
    same(LEXIS.tokens(given.header), LEXIS.tokens(own_header))
    prefix = base(given)
    cells = _members(own_header, f"{prefix}_approximation")
    inputs = _members(own_header, f"{prefix}_inputs")
    form = check_layout(given.text, own, prefix, cells, inputs)
    outcomes = tuple(name for name, _ in _OUTCOMES.findall(own_header))
    is_original = LEXIS.tokens(given.text) == LEXIS.tokens(own)
    return ParsedSource(own_rules, outcomes, form, cells, inputs, is_original)


def prepared(program: str, given: SourceText, checked: ParsedSource, folder: Path) -> BuiltLibrary:
    """The built library; nothing of it has run.

    Raises:
        ToolError: the compiler rejects the texts.
    """
    places = layout(given.header_name, base(given), checked.cells)
    binary = built(program, given.text, (given.header_name, given.header), places)
    library, digest = saved(binary, folder, base(given), checked.cells)
    return BuiltLibrary(library, binary.engine, {f"{Path(given.name).stem}.so": digest})


def base(given: SourceText) -> str:
    """Prefix of the names of types and functions, in checked texts."""
    (found,) = re.findall(r"} (\w+)_outcomes ;", " ".join(LEXIS.tokens(given.header)))
    return str(found)


def _written(given: SourceText, requirements: Sequence[FormalizedRequirement]) -> tuple[str, str]:
    """Text that fretc writes for these requirements; one file if the header's name says so."""
    for one_file in (False, True) if len(requirements) == 1 else (True,):
        files = {
            str(f.path): f.text for f in TARGET.emit(requirements, TargetOptions(one_file=one_file))
        }
        header = files.get(given.header_name)
        if header is not None:
            return files[given.header_name.removesuffix(".h") + ".c"], header
    raise UnexpectedLayoutError(
        f"`{given.header_name}` is not the name that fretc gives the header"
    )


def _members(header: str, name: str) -> tuple[str, ...]:
    """Members of a struct."""
    body = header[: header.index(f"\n}} {name};\n")].rpartition("typedef struct {")[2]
    return tuple(re.findall(r"^    \w+ (\w+)(?:\[\d+\])?;", body, re.MULTILINE))
