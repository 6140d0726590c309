"""The part of the closed loop from the channel to the wheels, and its behaviour in a tick.

It is independent of the monitors: loops with the same interceptor and channel share one model,
which computes each transition from one tick to the next once.
"""

from __future__ import annotations

from collections.abc import Mapping

from fretc.verification.interceptor.machine import Event, InterceptorMachine, State
from fretish.classes.frozen import dataclass

Queue = tuple[tuple[bool, int], ...]
"""Stop messages in flight, the oldest first: the request, and cells since it was sent."""


@dataclass(frozen=True, slots=True)
class ActuationAssumptions:
    """Assumptions about everything that is not code. Times are cells."""

    cells: int
    """Number of cells in a tick."""
    latency: int = 0
    lost: int = 0
    """Maximum number of stop messages that are lost in a row."""
    edge: bool = False
    """Whether requests are sent on change, not at every tick."""
    punctual: bool = False
    """Whether at least one command comes in every tick."""
    braking: int = 0
    scans: bool = False
    """Whether the interceptor receives scans."""
    heartbeat: int = 0
    """Ticks; with `edge`, a request is repeated after at most this silence; 0: never."""

    def __post_init__(self) -> None:
        assert self.cells >= 1
        assert min(self.latency, self.lost, self.braking, self.heartbeat) >= 0
        assert self.edge or not self.heartbeat

    @property
    def stands(self) -> int:
        """Ends of cells after which wheels with zero certainly stand."""
        return self.braking + 1


@dataclass(frozen=True, slots=True, eq=False)
class ActuationState:
    """A state of the model. Equal states are the same object.

    Sets of millions of nodes compare and hash states, so both operations use the identity.
    """

    interceptor: State
    still: int
    """Ends of cells since the wheels have had zero, up to `stands`; -1: they move."""
    queue: Queue


Word = tuple[Event | None, "Word | None"]
"""Last event, and all events before it; None: a cell ends."""
_Layer = dict[tuple[ActuationState, bool], Word]
"""Reachable states; and whether enough commands have come, if each tick brings some."""


class ActuationModel:
    """Channel, interceptor and wheels, driven by messages, the timer and time."""

    def __init__(self, interceptor: InterceptorMachine, channel: ActuationAssumptions) -> None:
        self.interceptor, self.channel = interceptor, channel
        self._inputs = [Event.MOVE, Event.STAND, *([Event.SCAN] if channel.scans else [])]
        self._known: dict[tuple[State, int, Queue], ActuationState] = {}
        self._heard: dict[ActuationState, tuple[tuple[Event, bool, ActuationState], ...]] = {}
        self._rung: dict[ActuationState, ActuationState] = {}
        self._later: dict[ActuationState, ActuationState | None] = {}
        self._passages: dict[ActuationState, Mapping[ActuationState, Word]] = {}
        self.initial = self.wheels(interceptor.initial, channel.stands, ())

    def wheels(self, interceptor: State, still: int, queue: Queue) -> ActuationState:
        """The unique object of a state."""
        key = interceptor, still, queue
        wheels = self._known.get(key)
        if wheels is None:
            wheels = self._known[key] = ActuationState(*key)
        return wheels

    def begun(self, wheels: ActuationState, still: int, sent: Queue) -> ActuationState:
        """The state at the beginning of a tick, with another message in flight, if any."""
        return self.wheels(wheels.interceptor, still, wheels.queue + sent)

    def passages(self, wheels: ActuationState) -> Mapping[ActuationState, Word]:
        """The states at the next tick, each with the events on the way."""
        passages = self._passages.get(wheels)
        if passages is None:
            passages = self._passages[wheels] = self._passing(wheels)
        return passages

    def _passing(self, wheels: ActuationState) -> Mapping[ActuationState, Word]:
        layer: _Layer = {}
        word: Word = (None, None)
        if self.channel.latency == 0:
            wheels, word = self._at_once(wheels, word)
        layer[wheels, not self.channel.punctual] = word
        for _ in range(self.channel.cells):
            layer = self._closed(layer)
            layer = {
                (self._ringing(wheels), enough): (Event.RING, word)
                for (wheels, enough), word in layer.items()
            }
            layer = self._older(self._closed(layer))
        return {wheels: word for (wheels, enough), word in layer.items() if enough}

    def _at_once(self, wheels: ActuationState, word: Word) -> tuple[ActuationState, Word]:
        """Without latency a message arrives at the very instant of the tick."""
        while wheels.queue:
            event = _message(wheels.queue)
            moved = wheels.still < 0
            wheels, word = self._take(wheels, event), (event, word)
            if moved and wheels.still == 0:
                wheels = self.wheels(wheels.interceptor, 1, wheels.queue)
        return wheels, word

    def _closed(self, layer: _Layer) -> _Layer:
        """States after any number of messages, in any order except that of the queue."""
        closure = dict(layer)
        waiting = list(layer)
        for key in waiting:
            wheels, enough = key
            word = closure[key]
            for event, commanded, heard in self._heard.get(wheels) or self._hearing(wheels):
                after = heard, enough or commanded
                if after not in closure:
                    closure[after] = (event, word)
                    waiting.append(after)
        return closure

    def _hearing(self, wheels: ActuationState) -> tuple[tuple[Event, bool, ActuationState], ...]:
        """Each message that can come next, whether it is a command, and the state after it."""
        queued = [_message(wheels.queue)] if wheels.queue else []
        heard = self._heard[wheels] = tuple(
            (event, event in (Event.MOVE, Event.STAND), self._take(wheels, event))
            for event in (*queued, *self._inputs)
        )
        return heard

    def _ringing(self, wheels: ActuationState) -> ActuationState:
        """The state after the timer has expired."""
        rung = self._rung.get(wheels)
        if rung is None:
            rung = self._rung[wheels] = self._take(wheels, Event.RING)
        return rung

    def _take(self, wheels: ActuationState, event: Event) -> ActuationState:
        interceptor, output = self.interceptor.step(wheels.interceptor, event)
        queue = wheels.queue[1:] if event in (Event.STOP, Event.RELEASE) else wheels.queue
        if output is None:
            return self.wheels(interceptor, wheels.still, queue)
        return self.wheels(interceptor, -1 if output else max(wheels.still, 0), queue)

    def _older(self, layer: _Layer) -> _Layer:
        """The end of a cell; states with a message in flight for too long are dropped."""
        result: _Layer = {}
        for (wheels, enough), word in layer.items():
            if wheels not in self._later:
                self._later[wheels] = self._aged(wheels)
            later = self._later[wheels]
            if later is not None:
                result.setdefault((later, enough), (None, word))
        return result

    def _aged(self, wheels: ActuationState) -> ActuationState | None:
        """The state a cell later; None: a message would have been in flight for too long."""
        still, queue = wheels.still, wheels.queue
        if queue and queue[0][1] + 1 >= self.channel.latency:
            return None
        older = tuple((requested, age + 1) for requested, age in queue)
        later = min(still + 1, self.channel.stands) if still >= 0 else still
        return self.wheels(wheels.interceptor, later, older)


def _message(queue: Queue) -> Event:
    return Event.STOP if queue[0][0] else Event.RELEASE
