"""What came of a program under test."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, Final, Literal

from compiler.files.records import Count, Name, Ordinal, Record, about, json_schema
from fretc.testing.suite import Repeat

SCHEMA: Final = "fretc-conformance-1"


class Outcome(StrEnum):
    """What came of an aim."""

    REACHED = "reached"
    UP_TO_PROGRAM = "up to the program"
    """No inputs force it, and the program did not bring it about."""
    NOT_REACHED = "not reached"
    """Inputs can force it, and yet it did not come."""
    NOT_SEARCHED = "not searched"


class Situated(Record, frozen=True):
    """A situation that the program was led to, or was to be led to."""

    requirement: Name
    situation: Name
    words: str
    outcome: Outcome
    why: Annotated[str, about("why it was not reached or not searched, if that is known")] = ""


class Failure(Record, frozen=True):
    """A run on which the program violates a requirement."""

    requirement: Name
    sentence: Name
    because: Annotated[str, about("the reason, in words")]
    rows: Annotated[tuple[Repeat, ...], about("inputs and outputs; the last tick violates it")]
    situation: Annotated[str, about("what the run was to show; empty: its inputs had no aim")]
    ticks: Annotated[Ordinal, about("of the run on which it was found")]
    tries: Annotated[Count, about("runs by which that one was made shorter")]
    again: Annotated[bool, about("whether the program did the same with the same inputs")]


class Conformance(Record, frozen=True):
    """All that was seen of a program."""

    schema: Literal["fretc-conformance-1"]
    fretc: Annotated[str, about("the version of fretc")]
    command: tuple[str, ...]
    requirements: tuple[Name, ...]
    runs: Annotated[Count, about("of the program, those that made a failure shorter among them")]
    ticks: Annotated[Count, about("of all runs together")]
    situations: tuple[Situated, ...]
    failures: tuple[Failure, ...]
    untried: Annotated[tuple[Name, ...], about("requirements of which no run began a demand")]
    whole: Annotated[bool, about("whether all runs were made; a mistake or Ctrl-C ends them")]
    not_judged: Annotated[dict[str, str], about("why a requirement has no monitor, by its id")]

    @property
    def is_complete(self) -> bool:
        """Whether all was searched, all was reached that can be forced, and all was asked for."""
        left = (Outcome.NOT_REACHED, Outcome.NOT_SEARCHED)
        reached = all(each.outcome not in left for each in self.situations)
        return self.whole and reached and not self.untried and not self.not_judged


def schema() -> dict[str, Any]:
    """The JSON Schema of what was seen."""
    return json_schema(
        Conformance,
        SCHEMA,
        "A program under test, as `fretc test --against` saw it",
        "Nothing depends on when it was made.",
    )
