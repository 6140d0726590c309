"""The tree of a FRETish sentence: what was written, and where.

The tree keeps `3 seconds`; how many ticks that is belongs to `fretish.clock`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, StrEnum, auto
from fractions import Fraction
from typing import Literal, assert_never

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


def ends_with_run(scope: ScopeKind | None) -> bool:
    """Whether an interval, once it has begun, lasts as long as the run."""
    match scope:
        case None | ScopeKind.AFTER | ScopeKind.ONLY_BEFORE:
            return True
        case ScopeKind.IN | ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return False
        case ScopeKind.BEFORE | ScopeKind.ONLY_AFTER:
            return False
        case _:
            assert_never(scope)


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


class Extent(Enum):
    """The ticks that a timing is about, seen from a trigger."""

    TRIGGER = auto()
    """The tick of the trigger."""
    NEXT = auto()
    """The tick after it."""
    LAST = auto()
    """The last tick of the interval."""
    INTERVAL = auto()
    """All from the trigger to the end of the interval."""
    DURATION = auto()
    """All from the trigger to the one that the duration counts to."""
    BEYOND = auto()
    """The tick after those; on them it asks for the opposite."""
    STOP = auto()
    """All from the trigger to the one before the stop condition."""

    @property
    def counts(self) -> bool:
        """Whether a duration says which ticks they are."""
        match self:
            case Extent.DURATION | Extent.BEYOND:
                return True
            case Extent.TRIGGER | Extent.NEXT | Extent.LAST | Extent.INTERVAL | Extent.STOP:
                return False
            case _:
                assert_never(self)

    @property
    def needs_end(self) -> bool:
        """Whether an interval without end asks for nothing."""
        match self:
            case Extent.LAST:
                return True
            case Extent.TRIGGER | Extent.NEXT | Extent.INTERVAL | Extent.DURATION:
                return False
            case Extent.BEYOND | Extent.STOP:
                return False
            case _:
                assert_never(self)


class Quantifier(Enum):
    """At how many of the ticks the response must be true."""

    ALL = auto()
    SOME = auto()
    NONE = auto()


@dataclass(frozen=True, slots=True)
class Shape:
    """What a timing asks for; no two timings ask for the same."""

    extent: Extent
    quantifier: Quantifier


SHAPES: Mapping[type[Timing], Shape] = {
    Immediately: Shape(Extent.TRIGGER, Quantifier.ALL),
    Next: Shape(Extent.NEXT, Quantifier.ALL),
    Finally: Shape(Extent.LAST, Quantifier.ALL),
    Eventually: Shape(Extent.INTERVAL, Quantifier.SOME),
    Always: Shape(Extent.INTERVAL, Quantifier.ALL),
    Never: Shape(Extent.INTERVAL, Quantifier.NONE),
    Within: Shape(Extent.DURATION, Quantifier.SOME),
    For: Shape(Extent.DURATION, Quantifier.ALL),
    After: Shape(Extent.BEYOND, Quantifier.ALL),
    Until: Shape(Extent.STOP, Quantifier.ALL),
    Before: Shape(Extent.STOP, Quantifier.SOME),
}
"""Each timing once; what asks which timing it is asks here, or names all of them."""


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
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return None
        case Until() | Before():
            return None
        case _:
            assert_never(timing)


def with_duration(timing: Timing, other: Duration) -> Timing:
    """The timing with another duration, if it counts one."""
    match timing:
        case Within() | For() | After():
            return replace(timing, duration=other)
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return timing
        case Until() | Before():
            return timing
        case _:
            assert_never(timing)


def stop(timing: Timing) -> Expression | None:
    """The stop condition of the timing, if it has one."""
    match timing:
        case Until(stop) | Before(stop):
            return stop
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return None
        case Within() | For() | After():
            return None
        case _:
            assert_never(timing)


def deadline(timing: Timing) -> Duration | None:
    """The duration within which one response is enough: that of `within`."""
    match timing:
        case Within(duration):
            return duration
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return None
        case For() | After() | Until() | Before():
            return None
        case _:
            assert_never(timing)


def is_eventual(timing: Timing) -> bool:
    """Whether one response is enough, however late in the interval: `eventually`, or no timing."""
    return SHAPES[type(timing)] == Shape(Extent.INTERVAL, Quantifier.SOME)


def with_expressions(sentence: Sentence, rewritten: Callable[[Expression], Expression]) -> Sentence:
    """The sentence with each of its Boolean expressions replaced."""
    scope, condition, timing = sentence.scope, sentence.condition, sentence.timing
    return replace(
        sentence,
        scope=scope and replace(scope, mode=rewritten(scope.mode)),
        condition=condition and replace(condition, expression=rewritten(condition.expression)),
        timing=replace(timing, stop=rewritten(timing.stop))
        if isinstance(timing, Until | Before)
        else timing,
        response=rewritten(sentence.response),
    )
