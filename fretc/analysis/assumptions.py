"""Assumptions about the environment: the sentences of `[[assume.requirement]]`."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalize import duplicate_ids, formalize, name_collisions
from compiler.formalization.formalized import FormalizedRequirement
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic, has_errors


def assumptions(
    requirements: Sequence[FormalizedRequirement], declarations: Declarations | None
) -> tuple[tuple[FormalizedRequirement, ...], tuple[Diagnostic, ...]]:
    """The assumptions as requirements, and their diagnostics.

    Args:
        requirements: the requirements; assumptions have other ids.
        declarations: the bindings; None: there are none.
    """
    if declarations is None or not declarations.environment:
        return (), ()
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
    return tuple(found), tuple(dict.fromkeys(said))
