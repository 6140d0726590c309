"""The type of a target: a kind of file that is generated from requirements."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Protocol

from compiler.files.artifact import Artifact
from compiler.files.attribution import NOBODY, Attribution
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.documents import RequirementEntry
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class TargetOptions:
    """Options that some targets read; the others ignore them."""

    notation: str = "plain"
    """A name of `printing.DIALECTS`."""
    simplify: bool = False
    """Whether to add a simplified form beside the exact one."""
    one_file: bool = False
    """Whether the monitors of all requirements go into one file."""
    free_texts: tuple[RequirementEntry, ...] = ()
    """Unformalized requirements, which only exchange formats include."""
    weaken: bool = False
    """Whether a target may emit a weaker form of the requirement, with a remark."""
    declarations: Declarations | None = None
    """The bindings, for files about the robot and not about one requirement."""
    attribution: Attribution = NOBODY
    """Maintainer and license, for manifests of packages."""


DEFAULT = TargetOptions()
LOOP = ("interceptor", "assume")
"""The tables of the bindings about the closed loop."""


class Emit(Protocol):
    """A function from requirements to files."""

    def __call__(
        self, requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
    ) -> tuple[Artifact, ...]:
        """The files of the requirements; a pure function."""


@dataclass(frozen=True, slots=True)
class Target:
    """One kind of output. After `refuse` accepts a requirement, `emit` never fails or weakens it.

    With `TargetOptions.weaken`, the `weak` form of the target may weaken it.
    """

    name: str
    summary: str
    emit: Emit
    refuse: Callable[[FormalizedRequirement], Diagnostic | None] = lambda requirement: None
    remark: Callable[[FormalizedRequirement], Diagnostic | None] = lambda requirement: None
    """A warning for the user of the output; it does not refuse the output."""
    refuse_project: Callable[[TargetOptions], Diagnostic | None] = lambda options: None
    """A reason to refuse the target for all requirements."""
    remarks: Callable[[TargetOptions], tuple[Diagnostic, ...]] = lambda options: ()
    """Warnings about the whole output, in addition to `remark`."""
    per_rule: bool = True
    """False if all requirements go into one file, for exchange with another tool."""
    joins: bool = False
    """Whether `TargetOptions.one_file` puts all requirements into one file."""
    refuse_joint: Callable[[Sequence[FormalizedRequirement]], Diagnostic | None] = (
        lambda requirements: None
    )
    """A reason to refuse one file for all requirements; none of them is refused alone."""
    of_bindings: bool = False
    """Whether the output depends only on the bindings."""
    reads: tuple[str, ...] = ()
    """The shared tables of the bindings that the target reads, as `LOOP`."""
    together: bool = False
    """Whether all requirements always become one monitor; `per_rule` is False then."""
    next_step: str = ""
    """A command for the first file, `{}`, and its effect."""
    names: Callable[[FormalizedRequirement], Mapping[str, str]] = lambda requirement: {}
    """The names of a requirement's propositions in the target's files."""
    weak: Target | None = None
    """The target when weakening is allowed: it refuses less, and remarks on the loss."""


def file_of_each(ending: str, text: Callable[[FormalizedRequirement, TargetOptions], str]) -> Emit:
    """The function `emit` of a target that writes one file, `<id>.ending`, for each requirement.

    Args:
        ending: the ending of the file, without a dot.
        text: the text of the file.
    """

    @with_recursion_limit
    def emit(
        requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
    ) -> tuple[Artifact, ...]:
        return tuple(
            Artifact(PurePosixPath(f"{stem(requirement)}.{ending}"), text(requirement, options))
            for requirement in requirements
        )

    return emit


def stem(requirement: FormalizedRequirement) -> str:
    """The name of the requirement's files, without their ending: the id in lower case."""
    return requirement.id.lower()


def identifier(requirement: FormalizedRequirement) -> str:
    """The id as an identifier: an id may begin with a digit."""
    plain = re.sub(r"\W", "_", stem(requirement))
    return f"r{plain}" if plain[:1].isdigit() else plain


def not_expressible(
    target: str, requirement: FormalizedRequirement, what: str, fix: str
) -> Diagnostic:
    """F601: the target's language cannot express a part of the requirement."""
    return diagnostic(
        "not_expressible",
        requirement.entry.wording,
        target=target,
        what=what,
        requirement=requirement.id,
        help=fix,
    )


_MOST_OPERATORS = 100_000
"""Maximum number of operators of a property."""


def too_long(
    target: str, requirement: FormalizedRequirement, formula: f.Formula
) -> Diagnostic | None:
    """F670 if the formula is too long without `<->` and `xor`."""
    if _size(formula) <= _MOST_OPERATORS:
        return None
    return diagnostic(
        "property_too_long",
        requirement.entry.wording,
        requirement=requirement.id,
        most=_MOST_OPERATORS,
        target=target,
    )


def _size(formula: f.Formula) -> int:
    """The number of operators in the text, where operands of `<->` and `xor` appear twice."""
    parts = sum(map(_size, f.children(formula)))
    return 1 + (2 * parts if isinstance(formula, f.Iff | f.Xor) else parts)
