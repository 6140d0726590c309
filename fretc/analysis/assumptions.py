"""What the environment is taken to keep: the sentences of `[[assume.requirement]]`."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalize import duplicate_ids, formalize, name_collisions
from compiler.formalization.formalized import FormalizedRequirement
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic, has_errors


def assumptions(
    rules: Sequence[FormalizedRequirement], declarations: Declarations | None
) -> tuple[tuple[FormalizedRequirement, ...], tuple[Diagnostic, ...]]:
    """The assumptions as rules, and all that there is to say of them.

    Args:
        rules: the requirements; an assumption has an id of its own.
        declarations: the bindings; None: there are none.
    """
    if declarations is None or not declarations.environment:
        return (), ()
    found: list[FormalizedRequirement] = []
    said: list[Diagnostic] = []
    for requirement in declarations.environment:
        rule, remarks = formalize(requirement, declarations)
        said.extend(remarks)
        if rule is not None:
            found.append(rule)
    said.extend(name_collisions([*rules, *found]))
    if not has_errors(said):
        every = [*(rule.requirement for rule in rules), *declarations.environment]
        said.extend(dict.fromkeys(duplicate_ids(every).values()))
    return tuple(found), tuple(dict.fromkeys(said))
