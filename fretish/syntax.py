"""The tree of a FRETish sentence: what was written, and where.

The tree keeps `3 seconds`; how many ticks that is belongs to `fretish.clock`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from typing import Literal

from fretish.diagnostics.source import Span
from fretish.expressions import ComparisonOperator, Expression


class ScopeKind(StrEnum):
    """Where a requirement is enforced; the values are FRET's keys."""

    IN = "in"
    NOT_IN = "notin"
    BEFORE = "before"
    AFTER = "after"
    ONLY_IN = "onlyIn"
    ONLY_BEFORE = "onlyBefore"
    ONLY_AFTER = "onlyAfter"

    @property
    def negates(self) -> bool:
        """`only` scopes demand the negated timing outside of themselves."""
        return self in (ScopeKind.ONLY_IN, ScopeKind.ONLY_BEFORE, ScopeKind.ONLY_AFTER)


@dataclass(frozen=True, slots=True)
class Scope:
    """`in m`, `before m`, `only after m`, ...; `while e` has the kind of `in e`."""

    kind: ScopeKind
    mode: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


class ConditionKind(StrEnum):
    """When a condition triggers; the values are FRET's keys."""

    TRIGGER = "regular"
    """`upon`, `when`, `if`, `where`, `unless`: at the points where it becomes true."""
    HOLDING = "holding"
    """`whenever`: at every point where it is true."""


@dataclass(frozen=True, slots=True)
class Condition:
    """All items of the condition, joined into one expression."""

    kind: ConditionKind
    expression: Expression
    word: str = field(default="", compare=False)
    """The first qualifier as written, in lower case: `when`, `upon`, ..."""
    span: Span | None = field(default=None, compare=False, repr=False)


TimeUnit = Literal["tick", "microsecond", "millisecond", "second", "minute", "hour"]


@dataclass(frozen=True, slots=True)
class Duration:
    """`3 seconds`: a whole number of units."""

    amount: int
    unit: TimeUnit
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Immediately:
    """At the trigger itself."""


@dataclass(frozen=True, slots=True)
class Next:
    """`at the next timepoint`."""


@dataclass(frozen=True, slots=True)
class Finally:
    """`at the last timepoint` of the scope."""


@dataclass(frozen=True, slots=True)
class Eventually:
    """At some point from the trigger on; also what a sentence without timing means."""

    explicit: bool = True
    """False where the sentence gives no timing (FRET's key `null`)."""


@dataclass(frozen=True, slots=True)
class Always:
    """At every point from the trigger on."""


@dataclass(frozen=True, slots=True)
class Never:
    """At no point from the trigger on."""


@dataclass(frozen=True, slots=True)
class Within:
    """No later than that after the trigger."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class For:
    """At every point from the trigger to that long after it."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class After:
    """Not before that has passed, and at the first point after it."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class Until:
    """At every point before the first at which `stop` holds."""

    stop: Expression


@dataclass(frozen=True, slots=True)
class Before:
    """At some point before the first at which `stop` holds, if there is one."""

    stop: Expression


Timing = (
    Immediately
    | Next
    | Finally
    | Eventually
    | Always
    | Never
    | Within
    | For
    | After
    | Until
    | Before
)


@dataclass(frozen=True, slots=True)
class Probability:
    """`with probability >= 0.9`."""

    op: ComparisonOperator
    bound: Fraction
    digits: str


@dataclass(frozen=True, slots=True)
class Sentence:
    """`[scope] [condition] component shall [probability] [timing] satisfy response`."""

    scope: Scope | None
    condition: Condition | None
    component: str
    probability: Probability | None
    timing: Timing
    response: Expression
    span: Span | None = field(default=None, compare=False, repr=False)
    component_span: Span | None = field(default=None, compare=False, repr=False)
    timing_span: Span | None = field(default=None, compare=False, repr=False)
    article: bool = field(default=False, compare=False, repr=False)
    """Whether `the` stands before the component."""


def scope_key(sentence: Sentence) -> str:
    """FRET's key of the scope: `null`, `in`, `notin`, `before`, ..."""
    return sentence.scope.kind.value if sentence.scope else "null"


def condition_key(sentence: Sentence) -> str:
    """FRET's key of the condition: `null`, `regular`, `holding`."""
    return sentence.condition.kind.value if sentence.condition else "null"


def timing_key(sentence: Sentence) -> str:
    """FRET's key of the timing: `null`, `immediately`, `within`, ..."""
    timing = sentence.timing
    if isinstance(timing, Eventually) and not timing.explicit:
        return "null"
    return type(timing).__name__.lower()


def duration(timing: Timing) -> Duration | None:
    """The duration that the timing counts, if it counts one."""
    match timing:
        case Within(duration) | For(duration) | After(duration):
            return duration
        case _:
            return None
