"""What monitors in languages with fixed memory share: their cells, names and largest bounds."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.identifiers import legal_names
from compiler.program.lowering import program
from compiler.program.program import Counter
from compiler.program.stored_program import Ring, StoredProgram, stored_program
from compiler.targets.comparison_names import comparison_names, in_words
from compiler.targets.python.monitor import watched
from compiler.targets.python.names import prefixes_of
from compiler.targets.target import not_expressible
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit

_MOST_BITS = 2**23
"""Maximum number of bits of a ring: a mebibyte for certain, and one for possible values."""


@with_recursion_limit
def too_large(requirement: FormalizedRequirement, language: str) -> Diagnostic | None:
    """F601 if a counter or a ring needs too much memory."""
    cells = stored_program(
        program({requirement.id: requirement.watch}), {requirement.id: "r"}
    ).cells
    if any(isinstance(cell, Counter) and cell.most >= 2**31 for cell in cells):
        what, fix = "a bound of 2^31 ticks or more", "counters have 32 bits: choose a longer tick"
    elif any(isinstance(cell, Ring) and cell.length > _MOST_BITS for cell in cells):
        what = f"a demand about a single tick more than {_MOST_BITS} ticks ago"
        fix = "it would keep more than a mebibyte: choose a longer tick"
    else:
        return None
    return not_expressible(f"a monitor in {language}", requirement, what, fix)


def monitor_program(
    requirements: Sequence[FormalizedRequirement], reserved: Container[str]
) -> StoredProgram:
    """The program of one monitor for all requirements.

    Args:
        requirements: requirements that are not refused.
        reserved: reserved names.
    """
    prefixes = prefixes_of([requirement.id for requirement in requirements])
    members = legal_names(prefixes, reserved, names=prefixes)
    return stored_program(
        program({requirement.id: requirement.watch for requirement in requirements}), members
    )


def input_names(
    requirements: Sequence[FormalizedRequirement], reserved: Container[str]
) -> Mapping[str, str]:
    """Proposition → its name among the inputs of a monitor for all requirements."""
    spoken: dict[str, str] = {}
    for requirement in requirements:
        spoken |= comparison_names(requirement)
    return legal_names(watched(requirements), reserved, names=spoken)


def inputs(
    requirements: Sequence[FormalizedRequirement], names: Mapping[str, str]
) -> list[dict[str, str]]:
    """The name and the meaning of each input, as values for a template."""
    meanings: dict[str, str] = {}
    for requirement in requirements:
        meanings |= in_words(requirement)
    return [{"name": own, "text": meanings.get(name, name)} for name, own in names.items()]
