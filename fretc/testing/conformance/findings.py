"""Results of a conformance test, as they are written and printed."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Final, Literal

from compiler.files.records import Count, Name, Ordinal, Record, about, json_schema
from fretc.testing.suite import Repeat

SCHEMA: Final = "fretc-conformance-1"


class GoalOutcome(StrEnum):
    """Result of the runs towards a goal."""

    REACHED = "reached"
    UP_TO_PROGRAM = "up to the program"
    """No inputs force the situation, and the program did not cause it."""
    NOT_REACHED = "not reached"
    """Inputs can force the situation, but it did not occur."""
    NOT_SEARCHED = "not searched"


class Situated(Record, frozen=True):
    """A situation that was a goal of runs."""

    requirement: Name
    situation: Name
    words: str
    outcome: GoalOutcome
    why: Annotated[str, about("why it was not reached or not searched, if that is known")] = ""


class Failure(Record, frozen=True):
    """A run on which the program violates a requirement."""

    requirement: Name
    sentence: Name
    because: Annotated[str, about("the reason, in words")]
    rows: Annotated[
        tuple[Repeat, ...], about("inputs and outputs; the last tick violates the requirement")
    ]
    situation: Annotated[str, about("the goal of the run; empty: its inputs were random")]
    ticks: Annotated[Ordinal, about("length of the run in which the failure was found, in ticks")]
    tries: Annotated[Count, about("number of runs that were used to shorten it")]
    again: Annotated[bool, about("whether the program did the same with the same inputs")]


class Conformance(Record, frozen=True):
    """All results about a program."""

    schema: Literal["fretc-conformance-1"]
    fretc: Annotated[str, about("the version of fretc")]
    command: tuple[str, ...]
    requirements: tuple[Name, ...]
    runs: Annotated[
        Count, about("number of runs of the program, including those that shortened a failure")
    ]
    ticks: Annotated[Count, about("ticks of all runs together")]
    situations: tuple[Situated, ...]
    failures: tuple[Failure, ...]
    untried: Annotated[tuple[Name, ...], about("requirements that no run triggered")]
    whole: Annotated[bool, about("whether all runs were made; an error or Ctrl-C ends the test")]
    not_judged: Annotated[dict[str, str], about("why a requirement has no monitor, by its id")]

    @property
    def is_complete(self) -> bool:
        """Whether the search is complete and every situation that can be forced was reached."""
        left = (GoalOutcome.NOT_REACHED, GoalOutcome.NOT_SEARCHED)
        reached = all(situation.outcome not in left for situation in self.situations)
        return self.whole and reached and not self.untried and not self.not_judged


def schema() -> dict[str, Any]:
    """The JSON Schema of the results."""
    return json_schema(
        Conformance,
        SCHEMA,
        "Result of testing a program, as `fretc test --against` writes it",
        "Nothing depends on when it was made.",
    )
