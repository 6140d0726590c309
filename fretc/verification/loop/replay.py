"""Replay of a run of the closed loop as a table, with freshly loaded code.

The code must behave as the model says: the replay steps monitors without saving and restoring
states, and the interceptor without encoded states.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from compiler.logic.claims import ClaimTrace
from fretc.verification.interceptor.machine import Event, InterceptorMachine
from fretc.verification.loop.model import Loop, LoopTick, Node
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.kernel.verdicts import VIOLATED, Truth
from monitors.loading import load

EXTRA = ("request", "delivered", "halt", "wheels")
"""Columns besides the propositions: the request, and its last delivery in the tick; at the end of
the tick, whether the interceptor is halted and whether the wheels have to move."""


class ReplayTick(NamedTuple):
    """A tick, and the events before the next one."""

    tick: LoopTick
    events: tuple[Event | None, ...]
    """Events; None: a cell ends."""


@dataclass(frozen=True, slots=True)
class LoadedMonitor:
    """Text of a monitor, and the index of the requirement in it."""

    text: str
    place: int

    def fresh(self) -> Monitor:
        """A new instance of the monitor before its first tick."""
        return load("monitor", self.text)


def moments(
    loop: Loop, start: Node, run: Sequence[tuple[LoopTick, Node]]
) -> tuple[ReplayTick, ...]:
    """The run with its events."""
    timeline, before = [], start
    for tick, after in run:
        timeline.append(ReplayTick(tick, loop.word(before, tick, after)))
        before = after
    return tuple(timeline)


def replayed(
    run: Sequence[ReplayTick],
    safety: LoadedMonitor,
    observer: LoadedMonitor,
    loop: Loop,
    cycle: int | None = None,
) -> tuple[ClaimTrace, bool]:
    """The run as a table, and whether the observer detects a violation at its last tick.

    Raises:
        AssertionError: the code does not behave as the model says.
    """
    again = _Replay(safety, observer, loop)
    rows = tuple(again.row(moment) for moment in run)
    names = (*loop.environment.atoms, *EXTRA)
    actions = tuple(map(_in_words, run))
    return ClaimTrace(names, rows, actions, cycle), again.violated


class _Replay:
    """Fresh instances of the code."""

    def __init__(self, safety: LoadedMonitor, observer: LoadedMonitor, loop: Loop) -> None:
        self._safety, self._observer = safety.fresh(), observer.fresh()
        self._places = safety.place, observer.place
        self._interceptor: InterceptorMachine = loop.interceptor
        self._channel, self._environment = loop.channel, loop.environment
        self._state: Any = loop.interceptor.raw_initial()
        self._still = loop.channel.stands
        self._flying: list[tuple[bool, int]] = []
        self._lost, self._silent, self._last_request = 0, 0, False
        self.violated = False

    def row(self, moment: ReplayTick) -> tuple[Truth, ...]:
        """Step all code by one tick; returns the row of the table."""
        tick = moment.tick
        self._sample(tick)
        self._step(self._safety, tick)
        self._step(self._observer, tick)
        self.violated = self._observer.verdicts()[self._places[1]] == VIOLATED
        signals = self._safety.certain.signals()[self._places[0]]
        assert bool(signals.trigger or signals.obligation_pending) == tick.requested
        self._send(tick)
        delivered = None
        for event in moment.events:
            if event in (Event.STOP, Event.RELEASE):
                assert self._flying.pop(0)[0] == (event is Event.STOP)
                delivered = event is Event.STOP
            self._take(event)
        halted = self._interceptor.is_halted(self._state)
        return (*tick.letter, tick.requested, delivered, halted, self._still < 0)

    def _sample(self, tick: LoopTick) -> None:
        stands = tick.letter[self._environment.atoms.index(self._environment.stands)]
        assert self._still >= 0 if stands else self._still < self._channel.stands
        self._still = self._channel.stands if stands else self._still

    def _step(self, monitor: Monitor, tick: LoopTick) -> None:
        monitor.advance([dict(zip(self._environment.atoms, tick.letter, strict=True))])

    def _send(self, tick: LoopTick) -> None:
        same = self._channel.edge and tick.requested == self._last_request
        beat = self._channel.heartbeat
        assert tick.again == (same and tick.sent is not None)
        assert beat or not tick.again
        assert tick.sent is not None or (same and (not beat or self._silent < beat))
        self._silent = self._silent + 1 if tick.sent is None else 1
        if tick.sent is not None:
            self._last_request, self._lost = tick.requested, 0 if tick.sent else self._lost + 1
        assert self._lost <= self._channel.lost
        if tick.sent:
            self._flying.append((tick.requested, 0))

    def _take(self, event: Event | None) -> None:
        if event is None:
            self._still += 1 if 0 <= self._still < self._channel.stands else 0
            self._flying = [(requested, age + 1) for requested, age in self._flying]
            assert all(age < self._channel.latency for _, age in self._flying)
            return
        instant = event in (Event.STOP, Event.RELEASE) and self._channel.latency == 0
        self._state, output = self._interceptor.raw_step(self._state, event)
        if output is not None:
            self._still = -1 if output else self._still if self._still >= 0 else int(instant)


# Words ----------------------------------------------------------------------------------------


def _in_words(moment: ReplayTick) -> str:
    """`a stop is requested, and the message is lost; a command to move is received`."""
    return "; ".join((*_message(moment.tick), *_deliveries(moment.events)))


def _message(tick: LoopTick) -> Iterator[str]:
    request = "a stop is requested" if tick.requested else "no stop is requested"
    again = " again" if tick.again else ""
    if tick.sent is None:
        yield f"{request}, and no message is sent" if tick.requested else request
    elif tick.sent:
        yield f"{request}, and the message is sent{again}"
    else:
        yield f"{request}, and the message is{' sent again, and' if tick.again else ''} lost"


def _deliveries(events: Sequence[Event | None]) -> Iterator[str]:
    """Events without expirations of the timer, whose number is the same in each tick."""
    yield from (event.value for event in events if event is not None and event is not Event.RING)
