"""The syntax tree of a FRETish sentence, with spans.

The tree keeps durations as written (`3 seconds`); `fretish.clock` converts them to ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from enum import Enum, StrEnum, auto
from fractions import Fraction
from typing import Literal, assert_never

from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Span
from fretish.expressions import ComparisonOperator, Expression


class ScopeKind(StrEnum):
    """Kind of scope; the values are FRET's keys."""

    IN = "in"
    NOT_IN = "notin"
    BEFORE = "before"
    AFTER = "after"
    ONLY_IN = "onlyIn"
    ONLY_BEFORE = "onlyBefore"
    ONLY_AFTER = "onlyAfter"

    @property
    def negates(self) -> bool:
        """Whether the scope is an `only` scope, which requires the negated timing outside of it."""
        return self in (ScopeKind.ONLY_IN, ScopeKind.ONLY_BEFORE, ScopeKind.ONLY_AFTER)


def ends_with_run(scope: ScopeKind | None) -> bool:
    """Whether an interval of the scope, once begun, lasts until the end of the run."""
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
    """Kind of condition; the values are FRET's keys."""

    TRIGGER = "regular"
    """`upon`, `when`, `if`, `where`, `unless`: triggers at the ticks at which it becomes true."""
    HOLDING = "holding"
    """`whenever`: triggers at every tick at which it is true."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition, with all its items joined into one expression."""

    kind: ConditionKind
    expression: Expression
    word: str = field(default="", compare=False)
    """The first key word as written, in lower case: `when`, `upon`, ..."""
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
    """`immediately`: at the tick of the trigger."""


@dataclass(frozen=True, slots=True)
class Next:
    """`at the next timepoint`."""


@dataclass(frozen=True, slots=True)
class Finally:
    """`at the last timepoint` of the scope."""


@dataclass(frozen=True, slots=True)
class Eventually:
    """`eventually`, or no timing: at some tick from the trigger on."""

    explicit: bool = True
    """False if the sentence has no timing (FRET's key `null`)."""


@dataclass(frozen=True, slots=True)
class Always:
    """`always`: at every tick from the trigger on."""


@dataclass(frozen=True, slots=True)
class Never:
    """`never`: at no tick from the trigger on."""


@dataclass(frozen=True, slots=True)
class Within:
    """`within 3 seconds`: at some tick from the trigger to the end of the duration."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class For:
    """`for 3 seconds`: at every tick from the trigger to the end of the duration."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class After:
    """`after 3 seconds`: false until the duration has passed, then true at the next tick."""

    duration: Duration


@dataclass(frozen=True, slots=True)
class Until:
    """`until p`: at every tick before the first one at which `stop` is true."""

    stop: Expression


@dataclass(frozen=True, slots=True)
class Before:
    """`before p`: at some tick before the first one at which `stop` is true, if there is one."""

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
    """The ticks that a timing refers to, relative to a trigger."""

    TRIGGER = auto()
    """The tick of the trigger."""
    NEXT = auto()
    """The tick after the trigger."""
    LAST = auto()
    """The last tick of the interval."""
    INTERVAL = auto()
    """All ticks from the trigger to the end of the interval."""
    DURATION = auto()
    """All ticks from the trigger to the end of the duration."""
    BEYOND = auto()
    """The tick after the duration; during it the opposite is required."""
    STOP = auto()
    """All ticks from the trigger to the one before the stop condition."""

    @property
    def counts(self) -> bool:
        """Whether a duration determines the ticks."""
        match self:
            case Extent.DURATION | Extent.BEYOND:
                return True
            case Extent.TRIGGER | Extent.NEXT | Extent.LAST | Extent.INTERVAL | Extent.STOP:
                return False
            case _:
                assert_never(self)

    @property
    def needs_end(self) -> bool:
        """Whether nothing is required in an interval without end."""
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
    """What a timing requires; each timing has a different shape."""

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
"""Timing → its shape. Code tests for a timing by this table, or by a `match` over all timings."""


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
    """The duration of the timing, or None."""
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
    """The timing with another duration; unchanged if it has none."""
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
    """The stop condition of the timing, or None."""
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
    """The duration of `within`, or None: the deadline for a single response."""
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
    """Whether one response at any later tick suffices: `eventually`, or no timing."""
    return SHAPES[type(timing)] == Shape(Extent.INTERVAL, Quantifier.SOME)


def with_expressions(sentence: Sentence, rewritten: Callable[[Expression], Expression]) -> Sentence:
    """The sentence with each of its Boolean expressions rewritten."""
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
