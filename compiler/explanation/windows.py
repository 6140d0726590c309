"""The demand of each trigger: the ticks at which the response matters, and its value there.

This is the definition of FRETish read trigger by trigger, for diagrams and for the reasons of
verdicts. Source: Giannakopoulou, Pressburger, Mavridou, Schumann, Automated formalization of
structured natural language requirements, IST 137 (2021), sections 3 and 4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import assert_never

from compiler.formalization.reference import Template
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, Extent, Quantifier, ScopeKind

Column = Sequence[bool]
"""One truth value for each tick of a finite trace, from tick 0 on."""


class Expectation(StrEnum):
    """The required value of the response on a stretch of ticks."""

    ALL = "true at each of these ticks"
    SOME = "true at one of these ticks, at least"
    NONE = "false at each of these ticks"
    MISS = "false at one of these ticks, at least"


@dataclass(frozen=True, slots=True)
class TickRange:
    """A stretch of ticks, both ends included, and the required response there.

    `last < first`: the stretch is empty, so nothing is true at one of its ticks.
    """

    first: int
    last: int
    need: Expectation

    def is_met(self, q: Column) -> bool:
        """Whether the response has the required value."""
        values = q[self.first : self.last + 1]
        match self.need:
            case Expectation.ALL:
                return all(values)
            case Expectation.SOME:
                return any(values)
            case Expectation.NONE:
                return not any(values)
            case Expectation.MISS:
                return not all(values)
            case _:
                assert_never(self.need)


@dataclass(frozen=True, slots=True)
class ObligationWindow:
    """The demand of one trigger."""

    trigger: int
    right: int
    """The last tick of the trigger's interval."""
    parts: tuple[TickRange, ...]
    """The parts of the demand; empty if there is none."""
    either: bool = False
    """Whether meeting one of the parts is enough."""

    def is_met(self, q: Column) -> bool:
        """Whether the response meets the demand."""
        met = [part.is_met(q) for part in self.parts]
        return not met or (any(met) if self.either else all(met))


def windows(template: Template, m: Column, p: Column, s: Column) -> tuple[ObligationWindow, ...]:
    """The demands of all triggers of a finite trace, in order.

    Args:
        template: the template of the sentence.
        m: the mode, shape (ticks,); any values where the template has none, as for p and s.
        p: the condition.
        s: the stop condition.
    """
    return tuple(
        window(template, trigger, right, s)
        for left, right in intervals(template.scope, m)
        for trigger in triggers(template.condition, p, left, right)
    )


def is_satisfied(template: Template, m: Column, p: Column, q: Column, s: Column) -> bool:
    """FRET's verdict on a finite trace: whether every trigger's demand is met."""
    return all(window.is_met(q) for window in windows(template, m, p, s))


def intervals(scope: ScopeKind | None, m: Column) -> list[tuple[int, int]]:
    """The stretches of ticks, both ends included, on which the sentence is enforced."""
    last = len(m) - 1
    runs = _runs(m)
    match scope:
        case None:
            return [(0, last)]
        case ScopeKind.IN:
            return runs
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return _runs([not value for value in m])
        case ScopeKind.BEFORE:
            interval = (0, runs[0][0] - 1) if runs else (0, last)
        case ScopeKind.AFTER:
            interval = (runs[0][1] + 1, last) if runs else (1, 0)
        case ScopeKind.ONLY_BEFORE:
            interval = (runs[0][0], last) if runs else (1, 0)
        case ScopeKind.ONLY_AFTER:
            interval = (0, runs[0][1]) if runs else (0, last)
        case _:
            assert_never(scope)
    return [interval] if interval[0] <= interval[1] else []


def _runs(column: Column) -> list[tuple[int, int]]:
    starts = [t for t, value in enumerate(column) if value and not (t and column[t - 1])]
    ends = [
        t for t, value in enumerate(column) if value and not (t + 1 < len(column) and column[t + 1])
    ]
    return list(zip(starts, ends, strict=True))


def triggers(condition: ConditionKind | None, p: Column, left: int, right: int) -> Iterator[int]:
    """The ticks of an interval at which a demand begins."""
    if condition is None:
        yield left
        return
    edges = condition is ConditionKind.TRIGGER
    for t in range(left, right + 1):
        if p[t] and not (edges and t > left and p[t - 1]):
            yield t


def window(template: Template, t: int, right: int, stops: Column) -> ObligationWindow:
    """The demand of the trigger at tick `t`, in an interval that ends with tick `right`."""
    negated = template.scope is not None and template.scope.negates
    throughout = Expectation.NONE if negated else Expectation.ALL
    whole, n = need(template), template.ticks
    waits = whole in (Expectation.SOME, Expectation.MISS)

    def asks(*parts: tuple[int, int, Expectation], either: bool = False) -> ObligationWindow:
        return ObligationWindow(t, right, tuple(TickRange(*part) for part in parts), either)

    extent = s.SHAPES[template.timing].extent
    match extent:
        case Extent.TRIGGER:
            return asks((t, t, throughout))
        case Extent.NEXT:
            return asks((t + 1, t + 1, throughout)) if t < right else asks()
        case Extent.LAST:
            return asks((right, right, throughout))
        case Extent.INTERVAL:
            return asks((t, right, whole))
        case Extent.DURATION if waits:  # a short interval asks for nothing
            return asks((t, t + n, whole)) if t + n <= right else asks()
        case Extent.DURATION:
            return asks((t, min(t + n, right), whole))
        case Extent.BEYOND:
            late = (t + n + 1, t + n + 1, throughout)
            if negated:
                return (
                    asks((t, t + n, Expectation.SOME), late, either=True)
                    if t + n < right
                    else asks()
                )
            early = (t, min(t + n, right), Expectation.NONE)
            return asks(early, late) if t + n < right else asks(early)
        case Extent.STOP:
            stop = next((k for k in range(t, right + 1) if stops[k]), None)
            if waits:
                return asks() if stop is None else asks((t, stop - 1, whole))
            last = right if stop is None else stop - 1
            return asks((t, last, whole)) if last >= t else asks()
        case _:
            assert_never(extent)


def has_deadline(template: Template) -> bool:
    """Whether it is too late for the response once the duration is over."""
    extent = s.SHAPES[template.timing].extent
    match extent:
        case Extent.DURATION:
            return need(template) in (Expectation.SOME, Expectation.MISS)
        case Extent.TRIGGER | Extent.NEXT | Extent.LAST | Extent.INTERVAL:
            return False
        case Extent.BEYOND | Extent.STOP:
            return False
        case _:
            assert_never(extent)


def need(template: Template) -> Expectation:
    """The required response on the ticks that the timing is about."""
    negated = template.scope is not None and template.scope.negates
    quantifier = s.SHAPES[template.timing].quantifier
    match quantifier:
        case Quantifier.ALL:
            return Expectation.MISS if negated else Expectation.ALL
        case Quantifier.SOME:
            return Expectation.NONE if negated else Expectation.SOME
        case Quantifier.NONE:
            return Expectation.SOME if negated else Expectation.NONE
        case _:
            assert_never(quantifier)
