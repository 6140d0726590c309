"""The closed loop as a graph: monitor, channel, interceptor, wheels, and any environment.

One step is one tick of the monitor's clock. The events of a step, in this order:

1. The propositions are sampled. The environment chooses all of them but the one that is true where
   the robot stands: false while the wheels have a command to move, true once they have had zero
   for the braking time; in between the environment chooses when it becomes true, and it stays so.
2. The safety function steps, as does the observer. The first requests a stop while a demand begins
   or is open; its message is lost or sent. Where it sends on change, it may repeat a request at any
   tick, and does after a silence as long as its heartbeat.
3. The tick has so many cells as the interceptor's timer rings in it, and in each cell it rings
   once. Before and after it, stop messages arrive in the order in which they were sent, and
   commands and scans in any number and order.
4. At the end of each cell time has passed: what is in flight is older, and no message is older than
   the latency allows; wheels that have zero have it for longer.

The wheels follow the last published velocity at once, and keep it until the next one. Times are
cells. One ring at any place in each cell models a timer of the same period, at any phase.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from compiler.formalization.letters import Valuation
from compiler.logic.orders import Exclusion, only_possible
from fretc.verification.interceptor.machine import Event, InterceptorMachine, State
from fretc.verification.monitor.machine import Stepped

Queue = tuple[tuple[bool, int], ...]
"""Stop messages in flight, the oldest first: the request, and cells since it was sent."""


@dataclass(frozen=True, slots=True)
class Channel:
    """The assumptions about everything that is not a text. Times are cells."""

    cells: int
    """To a tick."""
    latency: int = 0
    lost: int = 0
    """The most stop messages lost in a row."""
    edge: bool = False
    """Requests are sent on change, not at every tick."""
    punctual: bool = False
    """At least one command comes in every tick."""
    braking: int = 0
    scans: bool = False
    """The interceptor takes scans."""
    heartbeat: int = 0
    """With `edge`, in ticks: a request is repeated after such a silence, or earlier; 0: never."""

    def __post_init__(self) -> None:
        assert self.cells >= 1
        assert min(self.latency, self.lost, self.braking, self.heartbeat) >= 0
        assert self.edge or not self.heartbeat

    @property
    def stands(self) -> int:
        """Ends of cells after which wheels with zero stand for certain."""
        return self.braking + 1


class Wheels(NamedTuple):
    """The loop from the channel to the wheels."""

    interceptor: State
    still: int
    """Ends of cells since the wheels have zero, counted up to `Channel.stands`; -1: they move."""
    queue: Queue


class Node(NamedTuple):
    """The loop at the end of a tick."""

    safety: Hashable
    observer: Hashable
    wheels: Wheels
    losses: int
    """Stop messages lost since the last one that was not."""
    requested: bool
    """The request in the last stop message, lost or not."""
    silent: int
    """Ticks from the last stop message to the next tick, or from tick 0 where there was none; 0
    where no heartbeat counts them."""


class Tick(NamedTuple):
    """The facts about a tick that the node after it does not contain."""

    letter: Valuation
    triggered: bool
    owed: bool
    requested: bool
    sent: bool | None
    """None: no message; False: it is lost."""
    again: bool
    """The message repeats the last request, for the heartbeat."""
    violated: bool


Word = tuple[Event | None, "Word | None"]
"""The last event, and all events before it; None: a cell ends."""


@dataclass(frozen=True, slots=True)
class Environment:
    """The propositions, and the one of them that the wheels decide."""

    atoms: tuple[str, ...]
    stands: str
    excluded: tuple[Exclusion, ...] = ()
    """What the propositions cannot be together."""

    def letters(self, stands: bool) -> tuple[Valuation, ...]:
        """Every valuation with that value of the proposition that can occur."""
        choices = [(stands,) if name == self.stands else (False, True) for name in self.atoms]
        return only_possible(tuple(product(*choices)), self.atoms, self.excluded)


class Loop:
    """All parts, and the steps that they can take together."""

    def __init__(
        self,
        safety: Stepped,
        observer: Stepped | None,
        interceptor: InterceptorMachine,
        environment: Environment,
        channel: Channel,
    ) -> None:
        """Before the first tick: the robot stands, and no message has come or is in flight.

        Args:
            safety: the monitor that requests stops.
            observer: the monitor that detects violations; None: it has the text of `safety`.
            interceptor: what the commands pass on their way to the wheels.
            environment: the propositions in the order of letters.
            channel: the assumptions.
        """
        self._safety, self._observer = safety, observer
        self.interceptor, self.channel = interceptor, channel
        self.environment = environment
        self._place = environment.atoms.index(environment.stands)
        self._letters = {stands: environment.letters(stands) for stands in (False, True)}
        self._inputs = [Event.MOVE, Event.STAND, *([Event.SCAN] if channel.scans else [])]
        self._passages: dict[Wheels, dict[Wheels, Word]] = {}
        self._judgements: dict[tuple[Hashable, Hashable, Valuation], tuple[Hashable, ...]] = {}
        watching = observer.save() if observer else None
        wheels = Wheels(interceptor.initial, channel.stands, ())
        self.initial = Node(safety.save(), watching, wheels, 0, False, 0)

    # One tick -------------------------------------------------------------------------------

    def steps(self, node: Node) -> Iterator[tuple[Tick, Node]]:
        """Every tick that can follow, each with the node at its end."""
        for tick, begun in self.begins(node):
            for after in self.ends(begun):
                yield tick, after

    def begins(self, node: Node) -> Iterator[tuple[Tick, Node]]:
        """Every tick that can follow, each with the node at the moment of its message."""
        for stands, still in self._sampled(node.wheels.still):
            for letter in self._letters[stands]:
                yield from self._begins(node, letter, still)

    def ends(self, begun: Node) -> Iterator[Node]:
        """The nodes at the end of a tick that has begun so."""
        for wheels in self._passed(begun.wheels):
            yield begun._replace(wheels=wheels)

    def _sampled(self, still: int) -> list[tuple[bool, int]]:
        """Whether the robot stands, and the count of the wheels then."""
        if still < 0:
            return [(False, still)]
        certain = (True, self.channel.stands)
        return [certain] if still >= self.channel.stands else [(False, still), certain]

    def _begins(self, node: Node, letter: Valuation, still: int) -> Iterator[tuple[Tick, Node]]:
        safety, observer, triggered, owed, violated = self._judge(node, letter)
        requested = bool(triggered or owed)
        same = self.channel.edge and requested == node.requested
        for sent, losses in self._fates(node, same):
            facts = (bool(triggered), bool(owed), requested, sent, same and sent is not None)
            tick = Tick(letter, *facts, bool(violated))
            wheels, silent = self._begun(node.wheels, tick, still), self._silence(node, sent)
            yield tick, Node(safety, observer, wheels, losses, requested, silent)

    def _begun(self, wheels: Wheels, tick: Tick, still: int) -> Wheels:
        sent = ((tick.requested, 0),) if tick.sent else ()
        return Wheels(wheels.interceptor, still, wheels.queue + sent)

    def word(self, before: Node, tick: Tick, after: Node) -> tuple[Event | None, ...]:
        """The events from one end of a tick to the next; None: a cell ends."""
        stands = self.channel.stands if tick.letter[self._place] else before.wheels.still
        rest: Word | None = self._passed(self._begun(before.wheels, tick, stands))[after.wheels]
        events: list[Event | None] = []
        while rest is not None:
            events.append(rest[0])
            rest = rest[1]
        return tuple(events[-2::-1])  # the first one stands for nothing

    def _judge(self, node: Node, letter: Valuation) -> tuple[Hashable, ...]:
        key = (node.safety, node.observer, letter)
        judgement = self._judgements.get(key)
        if judgement is None:
            self._safety.load(node.safety)
            verdict, _ = self._safety.step(letter)
            triggered, owed = self._safety.demands()
            watching: Hashable = None
            if self._observer is not None:
                self._observer.load(node.observer)
                verdict, _ = self._observer.step(letter)
                watching = self._observer.save()
            saved = self._safety.save()
            judgement = (saved, watching, triggered, owed, verdict == "violated")
            self._judgements[key] = judgement
        return judgement

    def _fates(self, node: Node, same: bool) -> list[tuple[bool | None, int]]:
        """The possible fates of the message, each with the losses in a row after it.

        Args:
            node: before the tick.
            same: it would repeat the last request, so it need not be sent.
        """
        beat = self.channel.heartbeat
        quiet: list[tuple[bool | None, int]] = [(None, node.losses)]
        lost: list[tuple[bool | None, int]] = [(False, node.losses + 1)]
        if same and not beat:
            return quiet
        sent = [(True, 0), *(lost if node.losses < self.channel.lost else [])]
        return [*quiet, *sent] if same and node.silent < beat else sent

    def _silence(self, node: Node, sent: bool | None) -> int:
        """Ticks without a message, at the next tick."""
        if self.channel.edge and not self.channel.heartbeat:
            return 0
        return node.silent + 1 if sent is None else 1

    # From one tick to the next --------------------------------------------------------------

    def _passed(self, wheels: Wheels) -> dict[Wheels, Word]:
        """The states of the wheels at the next tick, each with a word of events on the way."""
        passage = self._passages.get(wheels)
        if passage is None:
            passage = self._passages[wheels] = self._passing(wheels)
        return passage

    def _passing(self, wheels: Wheels) -> dict[Wheels, Word]:
        layer: dict[tuple[Wheels, bool], Word] = {}
        word: Word = (None, None)
        if self.channel.latency == 0:
            wheels, word = self._at_once(wheels, word)
        layer[wheels, not self.channel.punctual] = word
        for _ in range(self.channel.cells):
            layer = self._closed(layer)
            layer = {
                (self._take(wheels, Event.RING), enough): (Event.RING, word)
                for (wheels, enough), word in layer.items()
            }
            layer = self._older(self._closed(layer))
        return {wheels: word for (wheels, enough), word in layer.items() if enough}

    def _at_once(self, wheels: Wheels, word: Word) -> tuple[Wheels, Word]:
        """Without latency a message arrives at the very instant of the tick."""
        while wheels.queue:
            event = _message(wheels.queue)
            moved = wheels.still < 0
            wheels, word = self._take(wheels, event), (event, word)
            if moved and wheels.still == 0:
                wheels = wheels._replace(still=1)
        return wheels, word

    def _closed(self, layer: dict[tuple[Wheels, bool], Word]) -> dict[tuple[Wheels, bool], Word]:
        """Any number of messages, in any order but that of the queue."""
        closure = dict(layer)
        waiting = list(layer)
        for key in waiting:
            wheels, enough = key
            queued = [_message(wheels.queue)] if wheels.queue else []
            for event in (*queued, *self._inputs):
                commanded = event in (Event.MOVE, Event.STAND)
                after = self._take(wheels, event), enough or commanded
                if after not in closure:
                    closure[after] = (event, closure[key])
                    waiting.append(after)
        return closure

    def _take(self, wheels: Wheels, event: Event) -> Wheels:
        interceptor, output = self.interceptor.step(wheels.interceptor, event)
        queue = wheels.queue[1:] if event in (Event.STOP, Event.RELEASE) else wheels.queue
        if output is None:
            return Wheels(interceptor, wheels.still, queue)
        return Wheels(interceptor, -1 if output else max(wheels.still, 0), queue)

    def _older(self, layer: dict[tuple[Wheels, bool], Word]) -> dict[tuple[Wheels, bool], Word]:
        """A cell ends; states with a message in flight for too long drop out."""
        result: dict[tuple[Wheels, bool], Word] = {}
        for ((interceptor, still, queue), enough), word in layer.items():
            if queue and queue[0][1] + 1 >= self.channel.latency:
                continue
            older = tuple((requested, age + 1) for requested, age in queue)
            later = min(still + 1, self.channel.stands) if still >= 0 else still
            result.setdefault((Wheels(interceptor, later, older), enough), (None, word))
        return result


def _message(queue: Queue) -> Event:
    return Event.STOP if queue[0][0] else Event.RELEASE
