"""The reason why a trace satisfies or violates a sentence, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from compiler.explanation.windows import (
    Column,
    Expectation,
    ObligationWindow,
    TickRange,
    intervals,
    need,
    windows,
)
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.reference import Letter, Template, template
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.meaning import span as in_ticks
from fretish.printer import expression
from fretish.syntax import Extent

_MOST = 2
"""Number of triggers that are explained one by one."""


def why(
    requirement: FormalizedRequirement,
    prefix: Sequence[Letter],
    loop: Sequence[Letter] = (),
    *,
    ends: bool = False,
    satisfied: bool | None = None,
) -> str:
    """The reason on one line.

    Args:
        requirement: the sentence.
        prefix: mode, condition, response and stop condition at each tick, at least one.
        loop: the ticks that repeat for ever after the prefix.
        ends: whether the run ends with the prefix. If it does not, and there is no loop, then what
            follows does not change the verdict, and the last tick is taken to repeat.
        satisfied: the verdict, if known; a contradicting reason is an internal error.
    """
    counted = template(requirement.sentence, requirement.ticks or 0)
    more = () if ends else tuple(loop or prefix[-1:]) * (counted.ticks + 3)
    m, p, q, stop = (tuple(column) for column in zip(*prefix, *more, strict=True))
    shown = len(prefix) + len(loop)
    every = [w for w in windows(counted, m, p, stop) if w.trigger < shown]
    displayed = [w for w in every if w.trigger < len(prefix)] or every
    writer = _ReasonWriter(requirement, counted, q, len(prefix) - 1, endless=bool(loop))
    broken = [window for window in every if not window.is_met(q)]
    assert satisfied is None or satisfied is not bool(broken), (counted, prefix, loop)
    if broken:
        return f"{writer.sentence(broken[0], met=False)}{writer.bound()}"
    if not displayed:
        return _nothing_demanded(requirement, counted, m)
    sentences = [writer.sentence(window, met=True) for window in displayed[:_MOST]]
    left = len(displayed) - _MOST
    rest = [f"and so on, {left} more time{'s' * (left > 1)}"] if left > 0 else []
    return f"{'; '.join([*sentences, *rest])}{writer.bound()}"


def _nothing_demanded(requirement: FormalizedRequirement, counted: Template, m: Column) -> str:
    """The reason if no demand begins."""
    scope, condition = requirement.written.scope, requirement.written.condition
    if not intervals(counted.scope, m):
        return "the sentence is enforced at none of these ticks: nothing is demanded"
    assert condition is not None, "without a condition each interval has a trigger"
    where = " where the sentence is enforced" if scope else ""
    return f"`{expression(condition.expression)}` is never true{where}: nothing is demanded"


@dataclass(frozen=True, slots=True)
class _ReasonWriter:
    """The words for one trace."""

    requirement: FormalizedRequirement
    counted: Template
    q: Column
    """The response at the ticks that are shown, and at those that follow."""
    shown: int
    """The last displayed tick."""
    endless: bool
    """Whether a loop that matters follows."""

    def sentence(self, window: ObligationWindow, *, met: bool) -> str:
        """`triggered at tick 1, ...`."""
        begun = "triggered" if self.requirement.sentence.condition else "begins"
        start = f"{begun} at tick {window.trigger}"
        if not window.parts:
            return f"{start}, {self._no_demand_reason(window)}"
        if window.either and not met:
            early, late = window.parts
            return (
                f"{start}, {self._name} is false at {_ticks(early.first, early.last)} and comes at "
                f"tick {late.first}, at which it is then forbidden"
            )
        chosen = [part for part in window.parts if part.is_met(self.q) is met]
        clause = self._met_clause if met else self._violation_clause
        clauses = " and ".join(
            clause(part, window) for part in chosen[: 1 if window.either else None]
        )
        return f"{start}, {clauses}"

    def bound(self) -> str:
        """The bound of the sentence in words."""
        if not self._extent.counts:
            return ""
        return f"; the bound is {in_ticks(self.counted.ticks, self.requirement.clock)}"

    @property
    def _name(self) -> str:
        return f"`{expression(self.requirement.written.response)}`"

    @property
    def _stop(self) -> str:
        stop = s.stop(self.requirement.written.timing)
        assert stop is not None
        return f"`{expression(stop)}`"

    @property
    def _extent(self) -> Extent:
        return s.SHAPES[self.counted.timing].extent

    @property
    def _stops(self) -> bool:
        return s.stop(self.requirement.sentence.timing) is not None

    def _hit(self, first: int, *, value: bool) -> int | None:
        return next((t for t in range(first, len(self.q)) if self.q[t] is value), None)

    def _met_clause(self, part: TickRange, window: ObligationWindow) -> str:
        value = _wanted(part)
        clause = f"{self._name} is {str(value).lower()}"
        if part.need in (Expectation.SOME, Expectation.MISS):
            hit = self._hit(part.first, value=value)
            assert hit is not None
            return f"{clause} at tick {hit}, {_later(hit - window.trigger)}"
        if part.last > self.shown:
            return f"{clause} from tick {part.first} on"
        return f"{clause} at {_ticks(part.first, part.last)}{self._end(part, window)}"

    def _end(self, part: TickRange, window: ObligationWindow) -> str:
        """The event that ends a demand without a duration."""
        if part.last < window.right:
            return f", until {self._stop}" if self._stops else ""
        if self._is_complete(part, window):
            return ""
        return f", where the {'scope' if self._is_closed(window) else 'run'} ends"

    def _is_complete(self, part: TickRange, window: ObligationWindow) -> bool:
        """Whether the demand would end at the same tick in a longer interval."""
        match self._extent:
            case Extent.TRIGGER | Extent.NEXT:
                return True
            case Extent.DURATION | Extent.BEYOND:
                return part.last >= window.trigger + self.counted.ticks
            case Extent.LAST | Extent.INTERVAL | Extent.STOP:
                return False
            case _:
                assert_never(self._extent)

    def _is_closed(self, window: ObligationWindow) -> bool:
        return window.right < len(self.q) - 1

    def _violation_clause(self, part: TickRange, window: ObligationWindow) -> str:
        value = _wanted(part)
        wanted, opposite = str(value).lower(), str(not value).lower()
        clause = f"{self._name} is {opposite}"
        if part.last < part.first:
            return f"{self._stop} is true at that same tick, before {self._name} is {wanted}"
        if part.need in (Expectation.ALL, Expectation.NONE):
            at = self._hit(part.first, value=not value)
            assert at is not None
            later = f", {_later(at - window.trigger)}" if at > window.trigger else ""
            return f"{clause} at tick {at}{later}{self._must(part, wanted)}"
        if self.endless and not self._is_closed(window):
            return f"{self._name} is never {wanted} from that tick on"
        late = part.last + 1
        if late <= self.shown and self.q[late] is value and self._extent.counts:
            return f"{self._name} is {wanted} at tick {late} only, one tick too late"
        end = self._end(part, window)
        if self._stops:
            end = f", and then {self._stop} is true"
        return f"{clause} at {_ticks(part.first, part.last)}{end}"

    def _must(self, part: TickRange, wanted: str) -> str:
        match self._extent:
            case Extent.LAST:
                return f", the last tick; it must be {wanted} there"
            case Extent.STOP:
                return f"; it must be {wanted} until {self._stop} is true"
            case Extent.INTERVAL:
                return f"; it must be {wanted} from tick {part.first} on"
            case Extent.TRIGGER | Extent.NEXT | Extent.DURATION | Extent.BEYOND:
                is_one_tick = part.first == part.last
                where = "there" if is_one_tick else f"at {_ticks(part.first, part.last)}"
                return f"; it must be {wanted} {where}"
            case _:
                assert_never(self._extent)

    def _no_demand_reason(self, window: ObligationWindow) -> str:
        """The reason why a trigger demands nothing, or nothing more."""
        match self._extent:
            case Extent.STOP:
                return self._stop_reason(window)
            case Extent.NEXT:
                return "the last tick of the scope: nothing is required"
            case Extent.DURATION:
                wanted = s.SHAPES[self.counted.timing].quantifier is s.Quantifier.SOME
                return self._too_short(window, self.counted.ticks, wanted=wanted)
            case Extent.BEYOND:
                return self._too_short(window, self.counted.ticks + 1, wanted=True)
            case Extent.TRIGGER | Extent.LAST | Extent.INTERVAL:
                raise AssertionError("its triggers always ask for something")
            case _:
                assert_never(self._extent)

    def _stop_reason(self, window: ObligationWindow) -> str:
        """The reason if the stop condition comes at once, not at all, or after the response."""
        negated = self.counted.scope is not None and self.counted.scope.negates
        if need(self.counted) in (Expectation.ALL, Expectation.NONE):
            return f"{self._stop} is true at that same tick: nothing is required"
        hit = self._hit(window.trigger, value=not negated)
        if hit is None or hit > self.shown:
            return f"{self._stop} does not come: nothing is required"
        value = str(not negated).lower()
        later = _later(hit - window.trigger)
        return f"{self._name} is {value} at tick {hit}, {later}, and {self._stop} not before"

    def _too_short(self, window: ObligationWindow, ticks: int, *, wanted: bool) -> str:
        """The reason if the interval ends before the deadline."""
        hit = self._hit(window.trigger, value=wanted)
        if hit is not None and hit <= window.right:
            later = _later(hit - window.trigger)
            return f"{self._name} is {str(wanted).lower()} at tick {hit}, {later}"
        deadline = window.trigger + ticks
        what = "scope" if self._is_closed(window) else "run"
        return (
            f"and the {what} ends at tick {window.right}, before the deadline at tick {deadline}: "
            "nothing is required"
        )


def _wanted(part: TickRange) -> bool:
    return part.need in (Expectation.ALL, Expectation.SOME)


def _later(ticks: int) -> str:
    if ticks == 0:
        return "at once"
    return f"{ticks} tick{'' if ticks == 1 else 's'} later"


def _ticks(first: int, last: int) -> str:
    return f"tick {first}" if first == last else f"ticks {first} to {last}"
