"""The diagram of a sentence's meaning, as values: scope, triggers, and open demands.

A sentence is drawn on one trace that shows all of its parts: the scope begins and ends, the
condition is true for two ticks, the stop condition comes. The content of the lanes is read off that
trace by the definition (`compiler.explanation.windows`), and not drawn separately for each form of
sentence. `compiler.explanation.drawing` computes the layout; the reader's names and numbers are all
in these values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import assert_never

from compiler.explanation.windows import Column, Expectation, ObligationWindow, intervals, windows
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.reference import Template, template
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.meaning import span as in_ticks
from fretish.printer import expression
from fretish.syntax import Extent, ScopeKind

_LEAD, _TAIL, _WAIT = 2, 2, 3
"""Ticks before and after the scope, and ticks to wait if the sentence sets no bound."""


class LaneKind(StrEnum):
    """What a lane shows."""

    MODE = "mode"
    """The ticks at which the mode is true."""
    SCOPE = "scope"
    """The ticks at which the sentence is enforced."""
    CONDITION = "condition"
    STOP = "stop"
    TRIGGER = "trigger"
    BOUND = "bound"
    """From a trigger to the tick that the duration counts to."""
    NEED = "need"
    """The ticks at which the response matters."""


@dataclass(frozen=True, slots=True)
class LaneInterval:
    """Ticks of a lane, both ends included."""

    first: int
    last: int
    goes_on: bool = False
    """Whether the stretch lasts until the end of the run, beyond the picture."""


@dataclass(frozen=True, slots=True)
class DiagramLane:
    """A row of the picture."""

    kind: LaneKind
    name: str
    """An expression of the sentence; empty for a lane without an expression."""
    note: str
    """The meaning of a bar in the lane."""
    stretches: tuple[LaneInterval, ...]
    need: Expectation | None = None
    """The required response, for `LaneKind.NEED`."""
    trigger: int | None = None
    """The tick of the trigger that makes the demand, if there are several triggers."""
    otherwise: bool = False
    """Whether the demand applies only if the demand of the lane before is not met."""

    @property
    def remark(self) -> str:
        """The text beside the lane, without its name."""
        link = "or else " if self.otherwise else ""
        whose = "" if self.trigger is None else f", trigger at tick {self.trigger}"
        return f"{link}{self.note}{whose}"


@dataclass(frozen=True, slots=True)
class DiagramTrace:
    """The drawn trace, with a column for each part of the sentence."""

    m: Column
    p: Column
    s: Column


@dataclass(frozen=True, slots=True)
class Diagram:
    """A sentence as a picture of some ticks of a run."""

    title: str
    ticks: int
    """The number of ticks in the picture; the run ends with them or continues."""
    ends: bool
    """Whether the run ends with the last tick of the picture."""
    period: int | None
    """Nanoseconds of a tick, if there is a clock."""
    lanes: tuple[DiagramLane, ...]
    trace: DiagramTrace
    windows: tuple[ObligationWindow, ...]
    """The demands of the triggers in the picture."""


def diagram(requirement: FormalizedRequirement) -> Diagram:
    """The diagram of a formalized sentence, for any bound."""
    drawn = template(requirement.sentence, requirement.ticks or 0)
    trace = _trace(drawn)
    obligations = windows(drawn, trace.m, trace.p, trace.s)
    ticks = len(trace.m)
    ends = s.SHAPES[drawn.timing].extent.needs_end and s.ends_with_run(drawn.scope)
    return Diagram(
        title=f"What {requirement.id} means",
        ticks=ticks,
        ends=ends,
        period=requirement.clock.period if requirement.clock else None,
        lanes=tuple(_lanes(requirement, drawn, trace, obligations, ticks if ends else ticks - 1)),
        trace=trace,
        windows=obligations,
    )


# The trace --------------------------------------------------------------------------------------


def _trace(drawn: Template) -> DiagramTrace:
    """A trace on which every part of the sentence has an effect."""
    lead = 0 if drawn.scope in (None, ScopeKind.BEFORE, ScopeKind.ONLY_AFTER) else _LEAD
    if drawn.scope is ScopeKind.AFTER:
        lead += 1  # a first run of the mode, with a tick before it
    begin = lead if drawn.condition is None else lead + 1
    late = begin if drawn.condition is None else begin + 1  # the last tick that may trigger
    right = late + _reach(drawn) + 1
    ticks = right + 1 if s.ends_with_run(drawn.scope) else right + 1 + _TAIL
    stop = late + _WAIT
    return DiagramTrace(
        m=tuple(_mode(drawn.scope, t, lead, right) for t in range(ticks)),
        p=tuple(begin <= t <= late for t in range(ticks)),
        s=tuple(t == stop for t in range(ticks)),
    )


def _reach(drawn: Template) -> int:
    """The number of ticks after a trigger for which its demand lasts."""
    extent = s.SHAPES[drawn.timing].extent
    match extent:
        case Extent.DURATION:
            return drawn.ticks
        case Extent.BEYOND:
            return drawn.ticks + 1
        case Extent.TRIGGER:
            return 1
        case Extent.NEXT:
            return 2
        case Extent.LAST | Extent.INTERVAL | Extent.STOP:
            return _WAIT
        case _:
            assert_never(extent)


def _mode(scope: ScopeKind | None, t: int, left: int, right: int) -> bool:
    """The mode at a tick, so that the interval is `left..right`."""
    inside = left <= t <= right
    match scope:
        case ScopeKind.IN:
            return inside
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return not inside
        case ScopeKind.BEFORE:
            return t > right
        case ScopeKind.AFTER:
            return 1 <= t < left
        case ScopeKind.ONLY_BEFORE:
            return left <= t < right
        case ScopeKind.ONLY_AFTER:
            return right - 1 <= t <= right
        case _:
            return False


# Lanes ------------------------------------------------------------------------------------------


def _lanes(
    requirement: FormalizedRequirement,
    drawn: Template,
    trace: DiagramTrace,
    obligations: Sequence[ObligationWindow],
    end: int,
) -> Iterator[DiagramLane]:
    """The lanes from top to bottom: scope, triggers, bound, response."""
    sentence = requirement.written
    scope, condition, stop = sentence.scope, sentence.condition, s.stop(sentence.timing)
    if scope is not None:
        yield DiagramLane(LaneKind.MODE, expression(scope.mode), "true", _true(trace.m))
    enforced = tuple(
        LaneInterval(left, right, goes_on=right >= end)
        for left, right in intervals(drawn.scope, trace.m)
    )
    yield DiagramLane(LaneKind.SCOPE, "", "enforced", enforced)
    if condition is not None:
        yield DiagramLane(
            LaneKind.CONDITION, expression(condition.expression), "true", _true(trace.p)
        )
    starts = tuple(LaneInterval(window.trigger, window.trigger) for window in obligations)
    yield DiagramLane(LaneKind.TRIGGER, "", "triggers" if condition else "begins", starts)
    if stop is not None:
        yield DiagramLane(LaneKind.STOP, expression(stop), "true", _true(trace.s))
    yield from _needs(requirement, drawn, obligations, end)


def _needs(
    requirement: FormalizedRequirement,
    drawn: Template,
    obligations: Sequence[ObligationWindow],
    end: int,
) -> Iterator[DiagramLane]:
    q = expression(requirement.written.response)
    several = len(obligations) > 1
    for window in obligations:
        whose = window.trigger if several else None
        if s.duration(requirement.sentence.timing) is not None:
            reach = LaneInterval(window.trigger, window.trigger + drawn.ticks)
            counted = in_ticks(drawn.ticks, requirement.clock)
            yield DiagramLane(LaneKind.BOUND, "", f"{counted} from tick {window.trigger}", (reach,))
        for number, part in enumerate(window.parts):
            where = LaneInterval(part.first, part.last, goes_on=_goes_on(drawn, part.last, end))
            need = _need(part.first == part.last, part.need)
            otherwise = window.either and number > 0
            yield DiagramLane(LaneKind.NEED, q, need, (where,), part.need, whose, otherwise)


def _goes_on(drawn: Template, last: int, end: int) -> bool:
    """Whether a demand lasts as long as an interval that lasts as long as the run."""
    extent = s.SHAPES[drawn.timing].extent
    match extent:
        case Extent.INTERVAL:
            return last >= end
        case Extent.TRIGGER | Extent.NEXT | Extent.LAST | Extent.DURATION:
            return False
        case Extent.BEYOND | Extent.STOP:
            return False
        case _:
            assert_never(extent)


def _need(single: bool, need: Expectation) -> str:
    if single:
        return "must be true" if need in (Expectation.ALL, Expectation.SOME) else "must be false"
    return {
        Expectation.ALL: "must be true throughout",
        Expectation.SOME: "must be true at least once",
        Expectation.NONE: "must be false throughout",
        Expectation.MISS: "must be false at least once",
    }[need]


def _true(column: Column) -> tuple[LaneInterval, ...]:
    """The stretches at which the column is true."""
    return tuple(LaneInterval(left, right) for left, right in intervals(ScopeKind.IN, column))


# Words ------------------------------------------------------------------------------------------


def words(drawn: Diagram) -> str:
    """The diagram as sentences, for readers who cannot see it."""
    end = "The run ends with the last tick" if drawn.ends else "The run goes on"
    lanes = [_in_words(lane) for lane in drawn.lanes if lane.kind is not LaneKind.BOUND]
    return " ".join([f"A run of ticks 0 to {drawn.ticks - 1}.", *lanes, f"{end}."])


def _in_words(lane: DiagramLane) -> str:
    at = " and ".join(_ticks(stretch) for stretch in lane.stretches)
    match lane.kind:
        case LaneKind.SCOPE:
            return f"The sentence is enforced at {at}."
        case LaneKind.TRIGGER:
            return f"It is triggered at {at}."
        case LaneKind.NEED:
            whose = "" if lane.trigger is None else f"For the trigger at tick {lane.trigger}, "
            link = "or else " if lane.otherwise else ""
            return f"{whose}{link}`{lane.name}` {lane.note}, at {at}."
        case _:
            return f"`{lane.name}` is true at {at}."


def _ticks(stretch: LaneInterval) -> str:
    if stretch.goes_on:
        return f"tick {stretch.first} and all later ones"
    if stretch.first == stretch.last:
        return f"tick {stretch.first}"
    return f"ticks {stretch.first} to {stretch.last}"
