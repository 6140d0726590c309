"""What a target is: a kind of file that rules become."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Protocol

from compiler.rule import Rule
from fretish.diagnostic import Code, Diagnostic


@dataclass(frozen=True, slots=True)
class Artifact:
    """A file to write, relative to the output folder."""

    path: PurePosixPath
    text: str


@dataclass(frozen=True, slots=True)
class Options:
    """How formulas are shown; targets for machines pass them over."""

    notation: str = "plain"
    """A name of `printing.DIALECTS`."""
    simplify: bool = False
    """Whether a simplified form stands beside the exact one."""


DEFAULT = Options()


class Emit(Protocol):
    """Rules → files."""

    def __call__(self, rules: Sequence[Rule], options: Options = DEFAULT) -> tuple[Artifact, ...]:
        """Make all files of the rules; pure."""


@dataclass(frozen=True, slots=True)
class Target:
    """One kind of output. `refuse` is asked first; `emit` then never fails and never weakens."""

    name: str
    summary: str
    emit: Emit
    refuse: Callable[[Rule], Diagnostic | None] = lambda rule: None


def stem(rule: Rule) -> str:
    """The name of the rule's files, without their ending: the id in lower case."""
    return rule.id.lower()


def not_expressible(target: str, rule: Rule, what: str, mend: str) -> Diagnostic:
    """F601: the target's language has no words for a part of the rule."""
    return Diagnostic(
        Code.NOT_EXPRESSIBLE,
        f"{target} cannot express {what} of {rule.id}",
        rule.requirement.wording,
        help=mend,
    )
