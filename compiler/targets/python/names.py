"""Names in a monitor: the module, the class, the prefix of each requirement, and the parameters."""

from __future__ import annotations

import re
from collections.abc import Iterable

from compiler.logic import printing
from compiler.logic.identifiers import legal_names, underlined
from compiler.logic.spelling.reserved_words import PYTHON
from compiler.targets.python.comparisons import NAMES
from compiler.targets.python.program import (
    locals_of,
    marks_of,
)
from monitors.source_text import kernel_of_variables

_RUN_TIME = frozenset(re.findall(r"^class (\w+)", kernel_of_variables().text, re.MULTILINE))
"""The classes of the copied kernel."""


def class_prefix(id: str) -> str:
    """The prefix of the two classes of a requirement; `Variable_` for `Variable`."""
    name = _identifier(id)
    wanted = underlined(f"{name[0].upper()}{name[1:]}")
    return next(n for n in wanted if _RUN_TIME.isdisjoint({f"{n}Approximation", f"{n}Monitor"}))


def _identifier(id: str) -> str:
    name = re.sub(r"\W", "_", id, flags=re.ASCII)
    return name if name[0].isalpha() else f"R{name}"


def module(name: str) -> str:
    """The file name as a module name that can be imported."""
    return re.sub(r"[^a-z0-9_]", "_", name)


def prefixes_of(ids: Iterable[str]) -> dict[str, str]:
    """An identifier for each id, all different."""
    prefixes: dict[str, str] = {}
    for id in ids:
        prefix = _identifier(id).lower()
        while prefix in prefixes.values():
            prefix += "_"
        prefixes[id] = prefix
    return prefixes


MOST_PARAMETERS = 60
"""Maximum number of parameters of a step, which takes a mapping if there are more: Python compares
each argument of a call with one parameter after the other."""
_SPOKEN = {"<=": "_le_", ">=": "_ge_", "!=": "_ne_", "<": "_lt_", ">": "_gt_", "=": "_eq_"}


def parameters_of(
    names: Iterable[str], prefixes: Iterable[str], variables: Iterable[str] = ()
) -> dict[str, str]:
    """A unique parameter for each proposition: its name as an identifier.

    If a monitor is stepped by variables, these get parameters, too.
    """
    variables = tuple(variables)
    marks = {name for prefix in prefixes for name in marks_of(prefix)}
    everything = (*names, *variables)
    return dict(
        legal_names(
            everything,
            PYTHON | {*marks, *(NAMES if variables else ())},
            names={name: _parameter(name) for name in everything},
            variants=underlined,
            brings=lambda name: locals_of([name]),
        )
    )


def _parameter(name: str) -> str:
    """The name as an identifier; a comparison is spelt in words."""
    text = _spoken(name) if printing.is_compound(name) else printing.identifier(name)
    return text if text[0].isalpha() else f"p_{text}"


def _spoken(text: str) -> str:
    """`(kias <= 90.0)` as `kias_le_90_0`."""
    for operator, word in _SPOKEN.items():
        text = text.replace(operator, word)
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_")
    return re.sub(r"_+", "_", name) or "p"
