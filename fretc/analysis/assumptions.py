"""Assumptions about the environment: `kind = "assumption"`, and `[[assume.requirement]]`."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalize import duplicate_ids, formalize, name_collisions
from compiler.formalization.formalized import FormalizedRequirement
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic, has_errors


def guarantees(
    requirements: Sequence[FormalizedRequirement],
) -> tuple[FormalizedRequirement, ...]:
    """The requirements that demand something of the system."""
    return tuple(each for each in requirements if not each.entry.is_assumption)


def assumptions(
    requirements: Sequence[FormalizedRequirement], declarations: Declarations | None
) -> tuple[tuple[FormalizedRequirement, ...], tuple[Diagnostic, ...]]:
    """The assumptions as requirements, and the diagnostics of those in the bindings.

    Args:
        requirements: all requirements; those of kind `assumption` come first in the result.
        declarations: the bindings; None: there are none.
    """
    own = tuple(each for each in requirements if each.entry.is_assumption)
    if declarations is None or not declarations.environment:
        return own, ()
    found: list[FormalizedRequirement] = []
    said: list[Diagnostic] = []
    for entry in declarations.environment:
        requirement, remarks = formalize(entry, declarations)
        said.extend(remarks)
        if requirement is not None:
            found.append(requirement)
    said.extend(name_collisions([*requirements, *found]))
    if not has_errors(said):
        every = [*(requirement.entry for requirement in requirements), *declarations.environment]
        said.extend(dict.fromkeys(duplicate_ids(every).values()))
    return (*own, *found), tuple(dict.fromkeys(said))
