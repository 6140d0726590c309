"""A twin of the closed loop in four whole numbers, as one relation for solvers and for Python.

It forgets everything but one demand that is open: for how long, what became of the first request
that was not lost since it began, and for how long the wheels have zero. So it may do more than the
loop, never less; that is checked step by step where the loop is small (`covered`), and what an
inductive invariant says of the twin is then true of the loop. Times are cells, those of
`compiler.loopmodel`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple, Protocol

from compiler.kripke import TooManyStatesError
from compiler.loopmodel import Channel, Loop, Node, Tick

NONE, ARRIVED = -1, -2
"""In place of the age of a request: none is in flight; one has been heard."""


class Numbers(NamedTuple):
    """The twin at the end of a tick; whole numbers, or terms of a solver."""

    open: Any
    """Ticks since the trigger of the oldest open demand; -1: none is open."""
    age: Any
    """Cells since the first request was sent that was not lost since then."""
    losses: Any
    """Messages that were lost since the last that was not."""
    still: Any
    """Ends of cells since the wheels have zero, up to `braking + 1`; -1: they move."""


class Choice(NamedTuple):
    """What is left open in a step."""

    stands: Any
    lost: Any
    cell: Any
    """In which the request is heard, if it is; -1: at the instant of the tick."""


class Times(NamedTuple):
    """The parameters; `cells` is a number in every use, the others may be terms."""

    cells: int
    latency: Any
    lost: Any
    braking: Any


class Logic(Protocol):
    """And, or: of truth values or of terms."""

    def both(self, *parts: Any) -> Any:
        """All of them."""

    def either(self, *parts: Any) -> Any:
        """At least one of them."""

    def no(self, part: Any) -> Any:
        """Not."""


class Plain:
    """Truth values of Python."""

    def both(self, *parts: Any) -> bool:
        """All of them."""
        return all(parts)

    def either(self, *parts: Any) -> bool:
        """At least one of them."""
        return any(parts)

    def no(self, part: Any) -> bool:
        """Not."""
        return not part


INITIAL = Numbers(-1, NONE, 0, None)
"""`still` is what it is when the robot stands: `braking + 1`."""


def begins(now: Numbers, times: Times, logic: Logic) -> Any:
    """Before the first tick."""
    return logic.both(
        now.open == -1, now.age == NONE, now.losses == 0, now.still == times.braking + 1
    )


def relation(now: Numbers, then: Numbers, choice: Choice, times: Times, logic: Logic) -> Any:
    """Whether the twin can go from one end of a tick to the next, by that choice."""
    both, either, no = logic.both, logic.either, logic.no
    sampled = both(
        either(no(choice.stands), now.still >= 0),
        either(choice.stands, now.still <= times.braking),
    )
    sent = either(
        both(choice.lost, now.losses < times.lost, then.losses == now.losses + 1),
        both(no(choice.lost), then.losses == 0),
    )
    ranges = both(then.open >= -1, then.still >= -1, then.still <= times.braking + 1)
    closed = both(then.open == -1, then.age == NONE)
    opened = both(
        no(choice.stands),
        either(
            both(now.open < 0, then.open == 0),
            both(now.open >= 0, then.open == now.open + 1),
        ),
        _requested(now, then, choice, times, logic),
    )
    return both(sampled, sent, ranges, either(closed, opened))


def _requested(now: Numbers, then: Numbers, choice: Choice, times: Times, logic: Logic) -> Any:
    """What becomes of the request in a tick at whose end the demand is open."""
    both, either, no = logic.both, logic.either, logic.no
    none = either(now.open < 0, now.age == NONE)
    waiting = both(no(none), now.age >= 0)
    heard = both(no(none), now.age == ARRIVED)
    k, end = times.cells, times.braking + 1
    return either(
        both(none, choice.lost, then.age == NONE),
        both(none, no(choice.lost), then.age == k, k < times.latency),
        both(none, no(choice.lost), then.age == ARRIVED, _heard(0, then, choice, times, logic)),
        both(waiting, then.age == now.age + k, then.age < times.latency),
        both(waiting, then.age == ARRIVED, _heard(now.age, then, choice, times, logic)),
        both(heard, then.age == ARRIVED, either(then.still >= end, then.still >= now.still + k)),
    )


def _heard(age: Any, then: Numbers, choice: Choice, times: Times, logic: Logic) -> Any:
    """A request of that age is heard in the cell of the choice; from then on zero is published."""
    both, either = logic.both, logic.either
    k = times.cells
    in_time = either(
        both(choice.cell == -1, times.latency == 0, age == 0),
        both(choice.cell >= 0, choice.cell < k, age + choice.cell + 1 <= times.latency),
    )
    end = times.braking + 1
    return both(in_time, either(then.still >= end, then.still >= k - choice.cell))


# Against the loop -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Covered:
    """What following the loop step by step has shown."""

    steps: int
    longest: int
    """The most ticks for which a demand is open; -1: none ever is."""
    strange: tuple[Numbers, Numbers] | None
    """A step of the loop that is none of the twin."""


def covered(loop: Loop, limit: int, longest: int) -> Covered:
    """Whether every step of the loop is one of the twin, over all states.

    Args:
        loop: whose safety function has no deadline, or up to its violation.
        limit: the most states.
        longest: ticks; where a demand is open for longer, it is looked no further.

    Raises:
        TooManyStatesError: there are more states than the limit.
    """
    channel = loop.channel
    times = Times(channel.cells, channel.latency, channel.lost, channel.braking)
    begin = INITIAL._replace(still=channel.stands)
    seen: set[tuple[Node, int, int]] = {(loop.initial, begin.open, begin.age)}
    allowed: dict[tuple[Numbers, Numbers], bool] = {}
    waiting, steps, most = list(seen), 0, -1
    for node, open_, age in waiting:
        now = Numbers(open_, age, node.losses, node.wheels.still)
        for tick, after in loop.steps(node):
            if tick.violated:
                continue
            steps += 1
            then = _followed(now, tick, after, channel)
            if (now, then) not in allowed:
                allowed[now, then] = _is_step(now, then, times)
            if not allowed[now, then]:
                return Covered(steps, most, (now, then))
            most = max(most, then.open)
            key = (after, then.open, then.age)
            if key not in seen and then.open <= longest:
                if len(seen) >= limit:
                    raise TooManyStatesError(limit)
                seen.add(key)
                waiting.append(key)
    return Covered(steps, most, None)


def _followed(now: Numbers, tick: Tick, after: Node, channel: Channel) -> Numbers:
    """What the twin remembers of a step of the loop."""
    losses, still = after.losses, after.wheels.still
    if not tick.owed:
        return Numbers(-1, NONE, losses, still)
    age = now.age if now.open >= 0 else NONE
    if age == NONE and tick.sent:
        age = 0
    if age >= 0:
        age += channel.cells
        flying = any(queued == age for _, queued in after.wheels.queue)
        age = age if flying else ARRIVED
    return Numbers(now.open + 1, age, losses, still)


def _is_step(now: Numbers, then: Numbers, times: Times) -> bool:
    return any(relation(now, then, choice, times, Plain()) for choice in _choices(times))


def _choices(times: Times) -> Iterator[Choice]:
    for stands, lost, cell in product((False, True), (False, True), range(-1, times.cells)):
        yield Choice(stands, lost, cell)
