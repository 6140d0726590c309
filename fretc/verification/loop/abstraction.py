"""An integer abstraction of the closed loop: six numbers and one relation between them.

It stores the oldest open obligation: its age, the state of the first request that was not lost
since the present stop began, and how long the wheels have had zero. Requests at every tick count as
a heartbeat of one tick. The abstraction may take more steps than the loop, never fewer: `covered`
checks that step by step for small parameters. So an inductive invariant of the abstraction holds
for the loop. Times are cells, those of `fretc.verification.loop.model`. Solvers and Python share
the relation.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple, Protocol

from compiler.logic.kripke import ModelTooLargeError
from fretc.verification.loop.actuation_model import ActuationAssumptions, Queue
from fretc.verification.loop.model import Loop, LoopTick, Node
from fretish.classes.frozen import dataclass

NONE, ARRIVED = -1, -2
"""Values in place of the age of a request: none is in flight; one has arrived."""


class TwinState(NamedTuple):
    """State of the abstraction at the end of a tick; integers, or terms of a solver."""

    open: Any
    """Ticks since the trigger of the oldest open obligation; -1: none is open."""
    age: Any
    """Cells since the sending of the first request of this stop that was not lost."""
    losses: Any
    """Messages lost since the last one that was not."""
    still: Any
    """Ends of cells since the wheels have had zero, at most `braking + 1`; -1: they move."""
    requested: Any
    """1: a stop is requested, whether a message was sent or not; 0: none is."""
    silent: Any
    """Ticks from the last message to the next tick."""


class StepChoice(NamedTuple):
    """Free choices of a step."""

    stands: Any
    sent: Any
    lost: Any
    """Whether the message is lost."""
    cell: Any
    """The cell in which the request arrives, if it does; -1: at the instant of the tick."""


class Times(NamedTuple):
    """Parameters; `cells` and `heartbeat` are always numbers, the others may be terms."""

    cells: int
    heartbeat: int
    """Maximum silence in ticks, after which the next message is sent, lost or not."""
    latency: Any
    lost: Any
    braking: Any


class Logic(Protocol):
    """Conjunction and disjunction, of truth values or of terms."""

    def both(self, *parts: Any) -> Any:
        """Conjunction."""

    def either(self, *parts: Any) -> Any:
        """Disjunction."""

    def no(self, part: Any) -> Any:
        """Negation."""


class Plain:
    """Logic of Python truth values."""

    def both(self, *parts: Any) -> bool:
        """Conjunction."""
        return all(parts)

    def either(self, *parts: Any) -> bool:
        """Disjunction."""
        return any(parts)

    def no(self, part: Any) -> bool:
        """Negation."""
        return not part


INITIAL = TwinState(-1, NONE, 0, None, 0, 0)
"""Initial values; `still` is `braking + 1`, because the robot stands."""


def begins(now: TwinState, times: Times, logic: Logic) -> Any:
    """The state before the first tick."""
    standing = now.still == times.braking + 1
    quiet = logic.both(now.losses == 0, now.requested == 0, now.silent == 0)
    return logic.both(now.open == -1, now.age == NONE, standing, quiet)


def relation(
    now: TwinState, then: TwinState, choice: StepChoice, times: Times, logic: Logic
) -> Any:
    """Whether the choice leads from one state at the end of a tick to the next."""
    both, either, no = logic.both, logic.either, logic.no
    sampled = both(
        either(no(choice.stands), now.still >= 0),
        either(choice.stands, now.still <= times.braking),
    )
    ranges = both(then.open >= -1, then.still >= -1, then.still <= times.braking + 1)
    opened = both(
        no(choice.stands),
        either(
            both(now.open < 0, then.open == 0),
            both(now.open >= 0, then.open == now.open + 1),
        ),
    )
    released = both(then.requested == 0, then.open == -1, then.age == NONE)
    request = both(
        then.requested == 1,
        either(then.open == -1, opened),
        _requested(now, then, choice, times, logic),
    )
    message = _message(now, then, choice, times, logic)
    return both(sampled, message, ranges, either(released, request))


def _message(
    now: TwinState, then: TwinState, choice: StepChoice, times: Times, logic: Logic
) -> Any:
    """Sending: each change is sent or lost, and a silence ends after the heartbeat."""
    both, either, no = logic.both, logic.either, logic.no
    quiet = both(
        then.requested == now.requested, now.silent < times.heartbeat, then.silent == now.silent + 1
    )
    lost = both(choice.lost, now.losses < times.lost, then.losses == now.losses + 1)
    delivered = both(no(choice.lost), then.losses == 0)
    return either(
        both(no(choice.sent), quiet, then.losses == now.losses),
        both(choice.sent, then.silent == 1, either(lost, delivered)),
    )


def _requested(
    now: TwinState, then: TwinState, choice: StepChoice, times: Times, logic: Logic
) -> Any:
    """The request, in a tick in which a stop is requested."""
    both, either, no = logic.both, logic.either, logic.no
    none = either(now.requested == 0, now.age == NONE)
    unsent, sent = either(no(choice.sent), choice.lost), both(choice.sent, no(choice.lost))
    waiting = both(no(none), now.age >= 0)
    arrived = both(no(none), now.age == ARRIVED)
    k, end = times.cells, times.braking + 1
    return either(
        both(none, unsent, then.age == NONE),
        both(none, sent, then.age == k, k < times.latency),
        both(none, sent, then.age == ARRIVED, _arrival(0, then, choice, times, logic)),
        both(waiting, then.age == now.age + k, then.age < times.latency),
        both(waiting, then.age == ARRIVED, _arrival(now.age, then, choice, times, logic)),
        both(arrived, then.age == ARRIVED, either(then.still >= end, then.still >= now.still + k)),
    )


def _arrival(age: Any, then: TwinState, choice: StepChoice, times: Times, logic: Logic) -> Any:
    """A request of that age arrives in the chosen cell; from then on zero is published."""
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
class AbstractionResult:
    """Result of comparing the loop with the abstraction step by step."""

    steps: int
    longest: int
    """Maximum number of ticks for which an obligation is open; -1: there is none."""
    uncovered: tuple[TwinState, TwinState] | None
    """A step of the loop that the abstraction cannot take; None: there is none."""


def covered(loop: Loop, limit: int, longest: int) -> AbstractionResult:
    """Whether the abstraction can take every step of the loop, over all states.

    Args:
        loop: a loop without a deadline, or up to its violation.
        limit: maximum number of states.
        longest: ticks; the search stops if an obligation is open for longer.

    Raises:
        ModelTooLargeError: there are more states than the limit.
    """
    channel = loop.channel
    assert channel.heartbeat or not channel.edge
    times = times_of(channel)
    begin = INITIAL._replace(still=channel.stands)
    visited: set[tuple[Node, int, int]] = {(loop.initial, begin.open, begin.age)}
    allowed: dict[tuple[TwinState, TwinState], bool] = {}
    ended: dict[tuple[TwinState, Node, bool, bool | None], int] = {}
    waiting, steps, most = list(visited), 0, -1
    for node, open_, age in waiting:
        now = _numbers(open_, age, node)
        for tick, begun in loop.begins(node):
            if tick.violated:
                continue
            case = now, begun, tick.obligation_pending, tick.sent
            if case in ended:  # The same steps belong to another valuation.
                steps += ended[case]
                continue
            before = steps
            follow: dict[tuple[int, Queue], TwinState] = {}
            for after in loop.ends(begun):
                steps += 1
                wheels = after.wheels.still, after.wheels.queue
                then = follow.get(wheels)
                if then is None:  # The abstraction ignores the interceptor's own state.
                    then = follow[wheels] = _followed(now, tick, after, channel)
                    most = max(most, then.open)
                    if (now, then) not in allowed:
                        allowed[now, then] = _is_step(now, then, times)
                    if not allowed[now, then]:
                        return AbstractionResult(steps, most, (now, then))
                key = (after, then.open, then.age)
                if key not in visited and then.open <= longest:
                    if len(visited) >= limit:
                        raise ModelTooLargeError(limit)
                    visited.add(key)
                    waiting.append(key)
            ended[case] = steps - before
    return AbstractionResult(steps, most, None)


def _followed(
    now: TwinState, tick: LoopTick, after: Node, channel: ActuationAssumptions
) -> TwinState:
    """State of the abstraction after a step of the loop."""
    if not tick.requested:
        return _numbers(-1, NONE, after)
    age = now.age if now.requested else NONE
    if age == NONE and tick.sent:
        age = 0
    if age >= 0:
        age += channel.cells
        flying = any(queued == age for _, queued in after.wheels.queue)
        age = age if flying else ARRIVED
    return _numbers(now.open + 1 if tick.obligation_pending else -1, age, after)


def _numbers(open_: int, age: int, node: Node) -> TwinState:
    return TwinState(open_, age, node.losses, node.wheels.still, int(node.requested), node.silent)


def times_of(channel: ActuationAssumptions) -> Times:
    """Times of a channel that repeats its requests: at every tick, or after a silence."""
    beat = channel.heartbeat if channel.edge else 1
    return Times(channel.cells, beat, channel.latency, channel.lost, channel.braking)


def _is_step(now: TwinState, then: TwinState, times: Times) -> bool:
    return any(relation(now, then, choice, times, Plain()) for choice in _choices(times))


def _choices(times: Times) -> Iterator[StepChoice]:
    fates = ((False, False), (True, False), (True, True))
    for stands, (sent, lost), cell in product((False, True), fates, range(-1, times.cells)):
        yield StepChoice(stands, sent, lost, cell)
