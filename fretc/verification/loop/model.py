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
from itertools import product
from typing import NamedTuple

from compiler.formalization.letters import Valuation
from compiler.logic.orders import Exclusion, only_possible
from fretc.verification.interceptor.machine import Event
from fretc.verification.loop.actuation_model import ActuationModel, ActuationState, Word
from fretc.verification.monitor.machine import Stepped
from fretish.classes.frozen import dataclass


class Node(NamedTuple):
    """State of the loop at the end of a tick."""

    safety: Hashable
    observer: Hashable
    wheels: ActuationState
    losses: int
    """Number of stop messages lost since the last one that was not."""
    requested: bool
    """Request in the last stop message, lost or not."""
    silent: int
    """Ticks from the last stop message, or from tick 0, to the next tick; 0 without a heartbeat."""


class LoopTick(NamedTuple):
    """Facts about a tick that the following node does not contain."""

    letter: Valuation
    triggered: bool
    obligation_pending: bool
    requested: bool
    sent: bool | None
    """None: no message; False: the message is lost."""
    again: bool
    """Whether the message repeats the last request, for the heartbeat."""
    violated: bool


@dataclass(frozen=True, slots=True)
class Environment:
    """The propositions, and the one that depends on the wheels."""

    atoms: tuple[str, ...]
    stands: str
    excluded: tuple[Exclusion, ...] = ()
    """Combinations of propositions that cannot occur."""

    def letters(self, stands: bool) -> tuple[Valuation, ...]:
        """Every possible valuation with this value of the wheels' proposition."""
        choices = [(stands,) if name == self.stands else (False, True) for name in self.atoms]
        return only_possible(tuple(product(*choices)), self.atoms, self.excluded)


class Loop:
    """All parts of the loop, and their common steps."""

    def __init__(
        self,
        safety: Stepped,
        observer: Stepped | None,
        drive: ActuationModel,
        environment: Environment,
    ) -> None:
        """The loop before the first tick: the robot stands, and no message is in flight.

        Args:
            safety: monitor that requests stops.
            observer: monitor that detects violations; None: it has the text of `safety`.
            drive: channel, interceptor and wheels; other loops may share it.
            environment: propositions in the order of valuations.
        """
        self._safety, self._observer = safety, observer
        self.drive, self.environment = drive, environment
        self.interceptor, self.channel = drive.interceptor, drive.channel
        self._place = environment.atoms.index(environment.stands)
        self._letters = {stands: environment.letters(stands) for stands in (False, True)}
        self._judgements: dict[tuple[Hashable, Hashable, Valuation], tuple[Hashable, ...]] = {}
        watching = observer.save() if observer else None
        self.initial = Node(safety.save(), watching, drive.initial, 0, False, 0)

    # One tick -------------------------------------------------------------------------------

    def steps(self, node: Node) -> Iterator[tuple[LoopTick, Node]]:
        """Every possible next tick, each with the node at its end."""
        for tick, begun in self.begins(node):
            for after in self.ends(begun):
                yield tick, after

    def begins(self, node: Node) -> Iterator[tuple[LoopTick, Node]]:
        """Every possible next tick, each with the node at the moment of its message."""
        for stands, still in self._sampled(node.wheels.still):
            for letter in self._letters[stands]:
                yield from self._begins(node, letter, still)

    def ends(self, begun: Node) -> Iterator[Node]:
        """Nodes at the end of a tick with this beginning."""
        safety, observer, before, losses, requested, silent = begun
        for wheels in self.drive.passages(before):
            yield Node(safety, observer, wheels, losses, requested, silent)

    def _sampled(self, still: int) -> list[tuple[bool, int]]:
        """Whether the robot stands, and the wheels' count then."""
        if still < 0:
            return [(False, still)]
        certain = (True, self.channel.stands)
        return [certain] if still >= self.channel.stands else [(False, still), certain]

    def _begins(self, node: Node, letter: Valuation, still: int) -> Iterator[tuple[LoopTick, Node]]:
        safety, observer, triggered, obligation_pending, violated = self._judge(node, letter)
        requested = bool(triggered or obligation_pending)
        same = self.channel.edge and requested == node.requested
        for sent, losses in self._fates(node, same):
            facts = (
                bool(triggered),
                bool(obligation_pending),
                requested,
                sent,
                same and sent is not None,
            )
            tick = LoopTick(letter, *facts, bool(violated))
            wheels, silent = self._begun(node.wheels, tick, still), self._silence(node, sent)
            yield tick, Node(safety, observer, wheels, losses, requested, silent)

    def _begun(self, wheels: ActuationState, tick: LoopTick, still: int) -> ActuationState:
        return self.drive.begun(wheels, still, ((tick.requested, 0),) if tick.sent else ())

    def word(self, before: Node, tick: LoopTick, after: Node) -> tuple[Event | None, ...]:
        """Events between the ends of two ticks; None: a cell ends."""
        stands = self.channel.stands if tick.letter[self._place] else before.wheels.still
        begun = self._begun(before.wheels, tick, stands)
        rest: Word | None = self.drive.passages(begun)[after.wheels]
        events: list[Event | None] = []
        while rest is not None:
            events.append(rest[0])
            rest = rest[1]
        return tuple(events[-2::-1])  # The first element is a placeholder.

    def _judge(self, node: Node, letter: Valuation) -> tuple[Hashable, ...]:
        key = (node.safety, node.observer, letter)
        judgement = self._judgements.get(key)
        if judgement is None:
            self._safety.load(node.safety)
            verdict, _ = self._safety.step(letter)
            triggered, obligation_pending = self._safety.demands()
            watching: Hashable = None
            if self._observer is not None:
                self._observer.load(node.observer)
                verdict, _ = self._observer.step(letter)
                watching = self._observer.save()
            saved = self._safety.save()
            judgement = (saved, watching, triggered, obligation_pending, verdict == "violated")
            self._judgements[key] = judgement
        return judgement

    def _fates(self, node: Node, same: bool) -> list[tuple[bool | None, int]]:
        """Whether the message is sent, lost or not needed, each with the losses in a row after it.

        Args:
            node: node before the tick.
            same: whether it would repeat the last request, so that it need not be sent.
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
