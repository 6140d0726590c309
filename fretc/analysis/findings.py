"""Findings of the analysis of a requirement set, as they are written and printed.

A requirement set is *realizable* if a system can choose its outputs tick by tick, knowing the
inputs up to and including that tick, and satisfy every requirement for all inputs. A question
without an answer within its limits is reported as `not checked`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any, Final, Literal

from compiler.files.records import UNSET, Count, Name, Record, UnsetType, about, json_schema
from fretc.analysis.arena.alphabet import Tick
from fretish.bindings.declarations import Role

SCHEMA: Final = "fretc-analysis-1"


class RealizabilityVerdict(StrEnum):
    """Whether the requirements are realizable. The values are those of files."""

    REALIZABLE = "realizable"
    UNREALIZABLE = "unrealizable"
    NOT_CHECKED = "not checked"


class Component(Record, frozen=True):
    """Requirements linked by shared outputs; no other requirement has these outputs."""

    requirements: Annotated[tuple[Name, ...], about("ids, in the order of the files")]
    outputs: Annotated[tuple[Name, ...], about("the outputs that the requirements are about")]
    verdict: RealizabilityVerdict
    why: Annotated[str, about("the method that decided it, or why it was not decided")]
    seconds: Annotated[
        float | UnsetType,
        about("CPU seconds; absent in the evidence file, which depends on the requirements alone"),
    ] = UNSET


class Conflict(Record, frozen=True):
    """A minimal set of requirements that cannot be satisfied together."""

    requirements: Annotated[tuple[Name, ...], about("ids, sorted")]
    play: Annotated[
        tuple[Tick, ...],
        about(
            "a run that the environment can force, tick by tick; empty if it was not found in time"
        ),
    ]
    because: Annotated[str, about("one sentence with the reason")]
    loop: Annotated[
        Count | None,
        about("the tick at which the repeated part begins; null: the run ends in a violation"),
    ] = None


class Repair(Record, frozen=True):
    """A proved change that resolves a conflict."""

    conflict: Annotated[tuple[Name, ...], about("the ids of the conflict that the repair resolves")]
    requirement: Annotated[
        Name | None, about("whose bound changes; null: the sentences are assumptions")
    ]
    sentences: Annotated[tuple[Name, ...], about("in FRETish")]
    settles: Annotated[
        bool, about("whether all requirements of the component can then be satisfied")
    ]


class Redundancy(Record, frozen=True):
    """A requirement that others imply: every run that satisfies them satisfies it."""

    requirement: Name
    by: Annotated[tuple[Name, ...], about("a minimal set of others that imply it; sorted")]


class Vacuity(Record, frozen=True):
    """A requirement with a part that never happens in runs that satisfy the others."""

    requirement: Name
    by: Annotated[tuple[Name, ...], about("a minimal set of others that exclude it; sorted")]
    what: Annotated[Literal["trigger", "scope"], about("the part that never happens")]


class Inconsistency(Record, frozen=True):
    """Requirements that become impossible to satisfy together after a run (rt-inconsistency).

    No single requirement is violated or impossible then.
    """

    requirements: Annotated[tuple[Name, ...], about("ids, sorted")]
    play: Annotated[tuple[Tick, ...], about("a shortest run to there")]


class Assumption(Record, frozen=True):
    """An assumption about the environment."""

    id: Name
    text: Annotated[str, about("in natural language; it may be empty")]
    sentence: Annotated[str, about("in FRETish")]

    @property
    def in_words(self) -> str:
        """`A1: the operator shall never satisfy start & stop (one button)`."""
        return f"{self.id}: {self.sentence}{f' ({self.text})' if self.text else ''}"


class OpenQuestion(Record, frozen=True):
    """A question without an answer."""

    question: Name
    why: Name


class Analysis(Record, frozen=True):
    """All findings about a requirement set."""

    schema: Literal["fretc-analysis-1"]
    fretc: Annotated[str, about("version of the tool")]
    verdict: RealizabilityVerdict
    why: str
    components: tuple[Component, ...]
    conflicts: tuple[Conflict, ...]
    complete: Annotated[bool, about("whether these are all minimal conflicts")]
    repairs: Annotated[tuple[Repair, ...], about("changes that would resolve each conflict")]
    redundant: tuple[Redundancy, ...]
    removable: Annotated[
        tuple[Name, ...],
        about("redundant requirements that the others imply even without all of these; sorted"),
    ]
    vacuous: tuple[Vacuity, ...]
    consistent: Annotated[
        bool | None, about("whether any run satisfies all of them; null: not known")
    ]
    inconsistent: Annotated[
        tuple[Inconsistency, ...], about("real-time inconsistencies, of pairs and triples first")
    ]
    always: Annotated[tuple[Name, ...], about("requirements that every run satisfies")]
    never: Annotated[tuple[Name, ...], about("requirements that no run satisfies")]
    assumptions: tuple[Assumption, ...]
    roles: Annotated[
        dict[str, Role],
        about(
            "the role of each variable: the environment chooses inputs, the system chooses "
            "outputs; `x of A` is the variable of the component A, if it has another role elsewhere"
        ),
    ]
    terms: Annotated[tuple[str, ...], about("the assumptions of the analysis, in words")]
    open: Annotated[tuple[OpenQuestion, ...], about("questions without an answer, and the reasons")]

    def roles_in(self, requirements: Sequence[str]) -> Mapping[str, Role]:
        """The role of each variable, as it is for some requirements of one system."""
        several = {name.split(" of ")[0] for name in self.roles if " of " in name} - {*self.roles}
        chosen = {
            name
            for each in self.components
            if not set(requirements).isdisjoint(each.requirements)
            for name in each.outputs
        }
        own = {name: Role.OUTPUT if name in chosen else Role.INPUT for name in several}
        return {**self.roles, **own}


def schema() -> dict[str, Any]:
    """The JSON Schema of what `fretc analyze --format json` prints."""
    return json_schema(
        Analysis,
        SCHEMA,
        "Whether requirements can be satisfied together, as `fretc analyze` writes it",
        "Nothing but `seconds` depends on when or where it was made.",
    )
