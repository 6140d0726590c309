"""The safety system: the safety function and the interceptor as parts that hear and say."""

from typing import Any

from simulation import messages
from simulation.bus import Bus
from simulation.safety import (
    CommandHeard,
    Decision,
    Intercepted,
    StopHeard,
    TimerRang,
    intercept,
    stop_requested,
)
from simulation.scenario import Interceptor, Safety

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


class SafetyFunction:
    """Hears /scan, /odom and /manual_control; says /gwendolen_control, on change and regularly."""

    def __init__(self, bus: Bus, decision: Decision, options: Safety, epoch: int) -> None:
        self._bus, self._decision = bus, decision
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
        self._answer(stop_requested(self._requested, demanded=demanded, manual=self._manual), now)

    def _answer(self, requested: bool, now: int) -> None:
        if requested != self._requested:
            self._requested = requested
            self._say(now)

    def _say(self, now: int) -> None:
        if self._end is None or now < self._end:
            message = messages.boolean(self._requested)
            late = self._late if now >= self._late_from else 0
            self._bus.publish("/gwendolen_control", message, now + ANSWER_LATENCY + late)


class Gate:
    """The interceptor: hears /gwendolen_control and /cmd_vel, says /cmd_vel_filtered."""

    def __init__(self, bus: Bus, options: Interceptor, epoch: int) -> None:
        self._bus, self._options = bus, options
        self._state = Intercepted()
        bus.subscribe("/gwendolen_control", self._hear_stop)
        bus.subscribe("/cmd_vel", self._hear_command)
        if options.period > 0:
            period = round(options.period * _SECOND)
            bus.every(period, epoch + period // 2, lambda now: self._take(TimerRang(), now))

    def _hear_stop(self, message: Any, now: int) -> None:
        self._take(StopHeard(bool(message.data)), now)

    def _hear_command(self, message: Any, now: int) -> None:
        self._take(CommandHeard(messages.velocity(message)), now)

    def _take(self, heard: StopHeard | CommandHeard | TimerRang, now: int) -> None:
        self._state, said = intercept(self._state, heard, now, self._options)
        if said is not None:
            self._bus.publish("/cmd_vel_filtered", messages.twist(said), now + INTERCEPT_LATENCY)
