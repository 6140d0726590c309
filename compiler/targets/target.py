"""What a target is: a kind of file that requirements become."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from compiler.files.artifact import Artifact
from compiler.files.attribution import NOBODY, Attribution
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.documents import RequirementEntry


@dataclass(frozen=True, slots=True)
class Options:
    """What some targets want to know beside the requirements; the others pass it over."""

    notation: str = "plain"
    """A name of `printing.DIALECTS`."""
    simplify: bool = False
    """Whether a simplified form stands beside the exact one."""
    one_file: bool = False
    """Whether the monitors of all requirements go into one file."""
    free_texts: tuple[RequirementEntry, ...] = ()
    """Requirements without a requirement, which only formats for exchange carry."""
    weaken: bool = False
    """Whether a target may say less than the requirement, where it then says so."""
    declarations: Declarations | None = None
    """What the bindings declare, for files about the robot and not about one requirement."""
    attribution: Attribution = NOBODY
    """Who answers for what is made, for manifests of packages."""


DEFAULT = Options()


class Emit(Protocol):
    """Requirements → files."""

    def __call__(
        self, requirements: Sequence[FormalizedRequirement], options: Options = DEFAULT
    ) -> tuple[Artifact, ...]:
        """Make all files of the requirements; pure."""


@dataclass(frozen=True, slots=True)
class Target:
    """One kind of output. `refuse` is asked first; `emit` then never fails and never weakens.

    Except where `Options.weaken` allows it, and the target has a `weak` form of itself.
    """

    name: str
    summary: str
    emit: Emit
    refuse: Callable[[FormalizedRequirement], Diagnostic | None] = lambda requirement: None
    remark: Callable[[FormalizedRequirement], Diagnostic | None] = lambda requirement: None
    """A warning for the user of the output; it does not refuse the output."""
    refuse_project: Callable[[Options], Diagnostic | None] = lambda options: None
    """Asked once: a reason to refuse the target for any requirements."""
    remarks: Callable[[Options], tuple[Diagnostic, ...]] = lambda options: ()
    """Warnings about the whole output, beside the `remark` on each requirement."""
    per_rule: bool = True
    """False where all requirements go into one file, for exchange with another tool."""
    joins: bool = False
    """Whether `Options.one_file` puts all requirements into one file."""
    of_bindings: bool = False
    """Whether it is made of the bindings alone, and reads no requirement."""
    of_loop: bool = False
    """Whether it reads `[interceptor]` and `[assume]` of the bindings."""
    together: bool = False
    """Whether all requirements always become one monitor; `per_rule` is False then."""
    next_step: str = ""
    """A command for the first file, `{}`, and what it does; for a person who makes one again."""
    names: Callable[[FormalizedRequirement], Mapping[str, str]] = lambda requirement: {}
    """What its texts call the propositions of a requirement that it does not refuse."""
    weak: Target | None = None
    """The same target where weakening is allowed: it refuses less, and remarks what is lost."""


def stem(requirement: FormalizedRequirement) -> str:
    """The name of the requirement's files, without their ending: the id in lower case."""
    return requirement.id.lower()


def identifier(requirement: FormalizedRequirement) -> str:
    """Its id in languages whose names begin with a letter: an id may begin with a digit."""
    plain = re.sub(r"\W", "_", stem(requirement))
    return f"r{plain}" if plain[:1].isdigit() else plain


def not_expressible(
    target: str, requirement: FormalizedRequirement, what: str, fix: str
) -> Diagnostic:
    """F601: the target's language has no words for a part of the requirement."""
    return Diagnostic(
        Code.NOT_EXPRESSIBLE,
        f"{target} cannot express {what} of {requirement.id}",
        requirement.entry.wording,
        help=fix,
    )


_MOST_OPERATORS = 100_000
"""Of a property."""


def too_long(
    target: str, requirement: FormalizedRequirement, formula: f.Formula
) -> Diagnostic | None:
    """F670 where the formula is endless once `<->` and `xor` are written with other operators."""
    if _size(formula) <= _MOST_OPERATORS:
        return None
    return Diagnostic(
        Code.TOO_LARGE,
        f"the property of {requirement.id} has more than {_MOST_OPERATORS} operators",
        requirement.entry.wording,
        help=f"{target}'s formulas have no `<->` and no `xor`: bind parts as propositions",
    )


def _size(formula: f.Formula) -> int:
    """How many operators the text has, with the operands of `<->` and `xor` written twice."""
    parts = sum(map(_size, f.children(formula)))
    return 1 + (2 * parts if isinstance(formula, f.Iff | f.Xor) else parts)
