"""Variables without a role: a verdict that holds for each player who may choose them."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import Roles
from fretish.bindings.declarations import Role, Variable

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_WORDS = frozenset(
    "if then else and or not xor div mod true false pre current when fby int real bool".split()
)
"""Key words of Lustre."""


def undeclared(requirements: Sequence[FormalizedRequirement], roles: Roles) -> tuple[str, ...]:
    """Names of variables without a single role, in the order of the sentences."""
    names = (name for requirement in requirements for name in requirement.variables)
    return tuple(dict.fromkeys(name for name in names if name not in roles))


def are_known_before_outputs(
    names: Sequence[str], requirements: Sequence[FormalizedRequirement], roles: Roles
) -> bool:
    """Whether each variable is chosen by a player, or computed from inputs alone.

    A value that depends on outputs of the same tick must not be known to the system before it
    chooses these: a strategy that reads it would not be one.

    Args:
        names: names without a role.
        requirements: requirements that read them.
        roles: roles of the other variables.
    """
    glossary: dict[str, Variable] = {}
    for requirement in requirements:
        glossary.update(requirement.glossary)
    inputs = {name for name, each in glossary.items() if each.role == Role.INPUT}
    inputs |= {name for name, role in roles.items() if role is Role.INPUT}
    inputs -= {name for name, role in roles.items() if role is not Role.INPUT}
    return all(_is_known(glossary.get(name), inputs) for name in names)


def _is_known(variable: Variable | None, inputs: Collection[str]) -> bool:
    if variable is None:
        return True
    assignment = _assignment(variable.fret)
    if not assignment:
        return variable.role != Role.INTERNAL
    read = {*_NAME.findall(assignment)} - _WORDS
    return read <= {*inputs}


def _assignment(fret: Mapping[str, object]) -> str:
    """The assignment of FRET that is not read."""
    return str(fret.get("assignment", "") or fret.get("modeRequirement", ""))
