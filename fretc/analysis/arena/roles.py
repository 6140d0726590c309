"""Roles of variables: the environment chooses inputs, the system chooses outputs.

A role is declared, never guessed, because realizability depends on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from compiler.formalization.binding_agreement import first_use
from compiler.formalization.formalized import FormalizedRequirement
from fretish import expressions as e
from fretish.bindings.calculations import without_calculations
from fretish.bindings.declarations import Declarations, Role
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.toml_text import as_key

Roles = Mapping[str, Role]
"""Role of each variable of the requirements that has a single one."""
CHOSEN = (Role.INPUT, Role.OUTPUT)


def roles(
    requirements: Sequence[FormalizedRequirement],
) -> tuple[Roles, tuple[Diagnostic, ...]]:
    """The role of each variable that has a single one, and the errors of the others.

    F354 is reported where a variable without a role is read first. F907 is about an input of one
    component that is an output of another. Requirements that read such a variable are not
    examined (`missing_role`).
    """
    found: dict[str, tuple[Role, str]] = {}
    wrong: dict[str, Diagnostic] = {}
    for requirement in requirements:
        for name in requirement.variables:
            own, component = role(requirement, name), requirement.sentence.component
            first, whose = found.get(name, (own, component))
            if own is None:
                wrong.setdefault(name, _no_role(requirement, name, requirements))
            elif own is not first:
                wrong.setdefault(name, _two_roles(requirement, name, f"{first} of `{whose}`", own))
            else:
                found[name] = own, whose
    known = {name: own for name, (own, _) in found.items() if name not in wrong}
    return known, tuple(wrong.values())


def missing_role(requirement: FormalizedRequirement, roles: Roles) -> str | None:
    """The first variable of the requirement without a single role; None: each has one."""
    return next((name for name in requirement.variables if name not in roles), None)


def _two_roles(
    requirement: FormalizedRequirement, name: str, first: str, second: Role
) -> Diagnostic:
    """F907."""
    component = requirement.sentence.component
    return diagnostic(
        "two_roles",
        first_use(requirement, name),
        name=name,
        first=first,
        second=second,
        component=component,
    )


def role(requirement: FormalizedRequirement, name: str) -> Role | None:
    """The declared role of a variable, or the common role of a proposition's signals."""
    variable = requirement.glossary.get(name)
    if variable is not None and variable.role in CHOSEN:
        return Role(variable.role)
    return _common(requirement.declarations, name) if requirement.declarations else None


def _common(declarations: Declarations, name: str) -> Role | None:
    proposition = declarations.propositions.get(name)
    if proposition is None:
        return None
    read = {name.id for name in e.names(without_calculations(proposition.expression))}
    signals = (declarations.measured.get(name) for name in read)
    theirs = {signal.role if signal is not None else None for signal in signals}
    common = theirs.pop() if len(theirs) == 1 else None
    return common if common in CHOSEN else None


def _no_role(
    requirement: FormalizedRequirement, name: str, requirements: Iterable[FormalizedRequirement]
) -> Diagnostic:
    """F354."""
    declared, table = requirement.declarations, "variable"
    if declared is not None:
        table = "proposition" if name in declared.propositions else table
        table = "signal" if name in declared.measured else table
    answered = any(name in _answers(each) for each in requirements)
    likely = Role.OUTPUT if answered else Role.INPUT
    why = "occurs in a response" if answered else "occurs in no response"
    variable = requirement.glossary.get(name)
    unread = str(variable.fret.get("assignment", "")) if variable is not None else ""
    if unread:
        shown = " ".join(unread.split())[:_SHOWN]
        what = f"has no role, and its assignment `{shown}` is not read"
    elif variable is not None and variable.role == Role.MODE:
        what = "is a mode without a role: it may be chosen by the system or by the environment"
    else:
        what = "has no role: it may be chosen by the environment or by the system"
    line = f'role = "{likely}"'
    table = f"[{table}.{as_key(name)}]"
    span, paste = first_use(requirement, name), f"{table}\n{line}"
    return diagnostic("no_role", span, name=name, what=what, table=table, why=why, paste=paste)


_SHOWN = 60
"""Maximum number of characters of an assignment in a message."""


def _answers(requirement: FormalizedRequirement) -> frozenset[str]:
    return frozenset(name.id for name in e.names(requirement.sentence.response))
