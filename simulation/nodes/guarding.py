"""The safety system: the safety function and the interceptor as parts that hear and say."""

from collections.abc import Callable, Sequence
from typing import Any

from simulation.nodes import messages
from simulation.nodes.bus import Bus
from simulation.nodes.safety import Agent, Decision, Interceptor, stop_requested
from simulation.world.motion import BodyVelocity
from simulation.world.scenario import Safety

ANSWER_LATENCY = 1_200_000
"""Nanoseconds from the message on /scan to the safety function's answer."""

INTERCEPT_LATENCY = 200_000
"""Nanoseconds from what the interceptor hears to what it says."""

HEARTBEAT = 500_000_000
"""Nanoseconds from one /gwendolen_control to the next, at most."""

WARM_UP = 10**9
"""Nanoseconds from the start; only then anything is late or lost."""

_SECOND = 10**9
_SCAN_PERIOD = 100_000_000


class SafetyFunctionNode:
    """Hears /scan, /odom and /manual_control; says /gwendolen_control, on change and regularly."""

    def __init__(
        self,
        bus: Bus,
        decision: Decision,
        options: Safety,
        epoch: int,
        agent: Agent | None = None,
    ) -> None:
        """`agent`: the same as `decision`, if that is an agent; it says /agent/trace, too."""
        self._bus, self._decision, self._agent = bus, decision, agent
        self._late = round(options.late * _SECOND)
        self._late_from = epoch + WARM_UP
        self._end = None if options.dies_at is None else epoch + round(options.dies_at * _SECOND)
        self._requested = self._manual = False
        self._scanned = epoch
        bus.subscribe("/odom", lambda message, now: decision.hear("/odom", message, now))
        bus.subscribe("/scan", self._hear_scan)
        bus.subscribe("/manual_control", self._hear_manual)
        bus.every(HEARTBEAT, epoch + HEARTBEAT // 50, self._say)
        bus.every(_SCAN_PERIOD, epoch + _SCAN_PERIOD // 2, self._watch)

    def _hear_scan(self, message: Any, now: int) -> None:
        self._scanned = now
        self._decision.hear("/scan", message, now)
        self._decide(now)

    def _watch(self, now: int) -> None:
        """No scan is something to decide on, too."""
        if now - self._scanned > 2 * _SCAN_PERIOD:
            self._decide(now)

    def _hear_manual(self, message: Any, now: int) -> None:
        self._manual = bool(message.data)
        self._answer(stop_requested(self._requested, demanded=False, manual=self._manual), now)

    def _decide(self, now: int) -> None:
        demanded = self._decision.step(now)
        for told in self._agent.told() if self._agent else ():
            self._bus.publish("/agent/trace", messages.text(told), now + ANSWER_LATENCY)
        self._answer(stop_requested(self._requested, demanded=demanded, manual=self._manual), now)

    def _answer(self, requested: bool, now: int) -> None:
        if requested != self._requested:
            self._requested = requested
            self._say(now)

    def _say(self, now: int) -> None:
        if self._agent is not None and not self._agent.speaks:
            return
        if self._end is None or now < self._end:
            message = messages.boolean(self._requested)
            late = self._late if now >= self._late_from else 0
            self._bus.publish("/gwendolen_control", message, now + ANSWER_LATENCY + late)


class Gate:
    """The interceptor: from /gwendolen_control and /cmd_vel to /cmd_vel_filtered."""

    def __init__(self, bus: Bus, interceptor: Interceptor, period: float, epoch: int) -> None:
        """`period` in seconds, 0: it has no timer."""
        self._bus, self._now = bus, epoch
        node = interceptor(self._say)
        bus.subscribe(
            "/gwendolen_control", lambda message, now: self._at(now, node.hear_stop, message)
        )
        bus.subscribe("/cmd_vel", lambda message, now: self._at(now, node.hear_command, message))
        if period > 0:
            every = round(period * _SECOND)
            bus.every(every, epoch + every // 2, lambda now: self._at(now, node.ring))

    def _at(self, now: int, take: Callable[..., None], *message: Any) -> None:
        self._now = now
        take(*message)

    def _say(self, velocity: Sequence[float]) -> None:
        message = messages.twist(BodyVelocity(velocity[0], velocity[5]))
        self._bus.publish("/cmd_vel_filtered", message, self._now + INTERCEPT_LATENCY)
