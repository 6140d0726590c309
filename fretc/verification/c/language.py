"""Monitors in C."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from pathlib import Path

from compiler.formalization.formalized import Formalized
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import Options
from fretc.verification.c.build import built, compiler, layout
from fretc.verification.c.form import LEXIS, formed
from fretc.verification.compiled.library import LibraryFile
from fretc.verification.compiled.plan import Checked, Given, Prepared, implemented
from fretc.verification.compiled.text import StrangeTextError, same

_OUTCOMES = re.compile(r"^    fretc_outcome (\w+); /\* (.*) \*/$", re.MULTILINE)
"""The members of that struct, and the ids beside them."""

tool = compiler


def prepared(program: str, given: Given, rules: Sequence[Formalized], folder: Path) -> Prepared:
    """The library; nothing of it has run.

    Raises:
        StrangeTextError: the texts are not in the form that fretc writes.
        ToolError: the compiler does not take them.
    """
    found = checked(given, rules)
    places = layout(given.header_name, found.base, found.cells)
    binary = built(program, given.text, (given.header_name, given.header), places)
    path = folder / "monitor.so"
    path.write_bytes(binary.data)
    library = LibraryFile(path, found.base, found.cells)
    digest = hashlib.sha256(binary.data).hexdigest()
    return Prepared(found, library, binary.engine, {f"{Path(given.name).stem}.so": digest})


def checked(given: Given, rules: Sequence[Formalized]) -> Checked:
    """The texts in the form that fretc writes.

    Args:
        given: they.
        rules: those that they may implement.

    Raises:
        StrangeTextError: they have another form.
    """
    own_rules = implemented([id for _, id in _OUTCOMES.findall(given.header)], rules)
    own, own_header = _written(given, own_rules)
    same(LEXIS.tokens(given.header), LEXIS.tokens(own_header))
    (base,) = re.findall(r"^} (\w+)_outcomes;$", own_header, re.MULTILINE)
    cells = _members(own_header, f"{base}_rail")
    form = formed(given.text, own, base, cells, _members(own_header, f"{base}_inputs"))
    outcomes = tuple(name for name, _ in _OUTCOMES.findall(own_header))
    return Checked(own_rules, outcomes, form, cells, base)


def _written(given: Given, rules: Sequence[Formalized]) -> tuple[str, str]:
    """What fretc writes for these rules: in one file if the header has the name of that."""
    for one_file in (False, True):
        files = {str(f.path): f.text for f in TARGET.emit(rules, Options(one_file=one_file))}
        header = files.get(given.header_name)
        if header is not None and (one_file or len(rules) == 1):
            return files[given.header_name.removesuffix(".h") + ".c"], header
    raise StrangeTextError(f"`{given.header_name}` is not the name that fretc gives the header")


def _members(header: str, name: str) -> tuple[str, ...]:
    """Of a struct."""
    body = header[: header.index(f"\n}} {name};\n")].rpartition("typedef struct {")[2]
    return tuple(re.findall(r"^    \w+ (\w+)(?:\[\d+\])?;", body, re.MULTILINE))
