"""Test suite as it is written and read back: runs with their verdicts, and what they cover."""

from __future__ import annotations

from enum import StrEnum
from itertools import chain, count
from typing import Annotated, Any, ClassVar, Final, Literal

from compiler.files.records import Count, Name, Ordinal, Record, Sha256, about, json_schema
from fretc.analysis.arena.alphabet import Value
from monitors.kernel.verdicts import Verdict

SCHEMA: Final = "fretc-tests-1"
LONGEST_NAME: Final = 100
"""Maximum length of the name of a test, which is also a file name."""
Ids = tuple[Name, ...]


class Repeat(Record, frozen=True):
    """Equal adjacent ticks."""

    count: Annotated[Ordinal, about("how many ticks")]
    values: Annotated[
        dict[str, Value | None],
        about(
            "the truth value of each atom and the number of each compared variable; null: unknown"
        ),
    ]


class Polarity(StrEnum):
    """Whether the run of a test satisfies its requirement."""

    KEPT = "kept"
    BROKEN = "broken"
    UNKNOWN = "unknown"
    """The verdict depends on an unknown value."""


class Test(Record, frozen=True):
    """One run, with the results of the requirement's monitor."""

    __test__: ClassVar[bool] = False  # Otherwise pytest collects the class.

    name: Annotated[Name, about("unique in the suite")]
    requirement: Name
    words: Annotated[str, about("the purpose of the test, as one sentence")]
    rows: Annotated[tuple[Repeat, ...], about("the ticks, from tick 0 on")]
    polarity: Annotated[Polarity, about("whether the run satisfies the requirement")]
    verdict: Annotated[Verdict, about("verdict of the monitor at the end of the run")]
    finite: Annotated[bool | None, about("FRET's verdict on the finite run")]
    decided: Annotated[
        Count | None,
        about(
            "the first tick after which no continuation changes the verdict; null: there is none"
        ),
    ]
    first_violation: Annotated[
        Count | None, about("the first tick at which the requirement is violated")
    ]
    because: Annotated[str, about("the reason of the verdict, in words")]
    situations: Annotated[tuple[Name, ...], about("the situations that the run covers")]
    kills: Annotated[tuple[Name, ...], about("the mutants that give the run another verdict")]

    @property
    def ticks(self) -> int:
        """Number of ticks."""
        return sum(row.count for row in self.rows)


class GoalStatus(StrEnum):
    """Result for a situation that a test should cover."""

    MET = "met"
    IMPOSSIBLE = "impossible"
    """Proved: no run of the requirement covers it with this polarity."""
    EXCLUDED = "excluded"
    """Proved: no run that satisfies the other requirements covers it."""
    NOT_SEARCHED = "not searched"


class GoalResult(Record, frozen=True):
    """A situation that tests cover, on a run that satisfies or violates the requirement.

    A situation with unknown values may be covered by either run.
    """

    requirement: Name
    situation: Name
    words: str
    polarity: Polarity
    outcome: GoalStatus
    tests: Annotated[
        tuple[Name, ...], about("the tests that cover the situation, shortest first")
    ] = ()
    by: Annotated[Ids, about("a minimal set of requirements that exclude the situation")] = ()
    why: Annotated[str, about("why no test was searched; empty: it was searched")] = ""


class MutantStatus(StrEnum):
    """Result for a mutant."""

    KILLED = "killed"
    EQUIVALENT = "equivalent"
    """Proved: it gives every finite run the verdict of the requirement."""
    EXCLUDED = "excluded"
    """Proved: the same verdict for every finite run that satisfies the other requirements."""
    NOT_SEARCHED = "not searched"


class MutantResult(Record, frozen=True):
    """A mutant of a requirement's sentence, with its result."""

    requirement: Name
    key: Name
    words: str
    sentence: str
    outcome: MutantStatus
    tests: Annotated[tuple[Name, ...], about("the tests that kill the mutant")] = ()
    by: Annotated[Ids, about("a minimal set of requirements that hide the difference")] = ()
    why: Annotated[str, about("why no test was searched; empty: it was searched")] = ""


class Tested(Record, frozen=True):
    """A requirement of a suite, with its fingerprint."""

    id: Name
    sentence: Name
    fingerprint: Sha256
    kept: Annotated[Ids, about("requirements and assumptions that its tests also satisfy")]
    doubt: Annotated[
        str,
        about("why the values of its tests may be impossible; empty: they are possible"),
    ] = ""


class Suite(Record, frozen=True):
    """All tests of a project."""

    schema: Literal["fretc-tests-1"]
    fretc: Annotated[str, about("the version of fretc")]
    clock: Annotated[str, about("the length of a tick; empty: not declared")]
    requirements: tuple[Tested, ...]
    roles: Annotated[
        dict[str, str], about("the role of each variable with a declared role: input or output")
    ]
    tests: tuple[Test, ...]
    obligations: tuple[GoalResult, ...]
    mutants: tuple[MutantResult, ...]

    @property
    def is_complete(self) -> bool:
        """Whether no search is missing."""
        met = all(
            obligation.outcome is not GoalStatus.NOT_SEARCHED for obligation in self.obligations
        )
        return met and all(
            mutant.outcome is not MutantStatus.NOT_SEARCHED for mutant in self.mutants
        )


def unused(name: str, names: set[str]) -> str:
    """An unused name, shortened and numbered if needed; it is added to `names`."""
    ends = chain([""], (f"-{number}" for number in count(2)))
    candidates = (name[: LONGEST_NAME - len(end)].rstrip("-") + end for end in ends)
    found = next(each for each in candidates if each not in names)
    names.add(found)
    return found


def schema() -> dict[str, Any]:
    """The JSON Schema of a suite."""
    return json_schema(
        Suite,
        SCHEMA,
        "Tests from requirements, as `fretc test` writes them",
        "Nothing depends on when or where it was made.",
    )
