"""The safety system as pure functions: how near things are, who must stop, what the wheels hear.

No input, no output, no clock: each step takes values and gives values.
"""

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from simulation import scenario
from simulation.lidar import Lidar
from simulation.motion import STANDSTILL, Velocity
from simulation.scene import ROBOT, Box

SAFE_DISTANCE = 0.05
"""Metres from the outline; nearer is too close (R1 of the inspection experiment)."""

_SECOND = 10**9


def outline_clearance(ranges: NDArray[np.floating], lidar: Lidar, outline: Box) -> float:
    """Metres between the robot's outline and the nearest thing that a scan saw.

    Args:
        ranges: shape (n,), n at most `lidar.beams`, from the lidar's first beam on.
        lidar: the sensor, at the origin of the outline's frame and turned as it is.
        outline: the robot seen from above.

    Returns:
        0 for a return inside the outline and for one too near to measure (-inf, or a positive
        range below `range_min`); +inf if the scan saw nothing although it looked; NaN if
        nothing is known, because no beam gave an answer. Single NaN beams are passed over.

    Source: REP 117, Informational Distance Measurements.
    """
    if np.any(np.isneginf(ranges) | ((ranges > 0) & (ranges < np.float32(lidar.range_min)))):
        return 0.0
    points = lidar.points(ranges)
    if len(points.x):
        return float(outline.distance(points.x, points.y).min())
    return float("inf") if np.any(ranges > np.float32(lidar.range_max)) else float("nan")


class Decision(Protocol):
    """What decides whether the robot must stop: the monitor of a requirement stands here."""

    def hear(self, topic: str, message: Any, time: int) -> None:
        """A message of /scan or /odom has arrived; `time` in nanoseconds."""
        ...

    def step(self, time: int) -> bool:
        """True if the robot must stop now; asked at each scan, and when none comes."""
        ...


class TooClose:
    """R1 by hand: stop when the clearance is below `threshold` metres, or unknown."""

    def __init__(
        self, lidar: Lidar, threshold: float = SAFE_DISTANCE, max_age: float = 0.3
    ) -> None:
        self._lidar, self._threshold = lidar, threshold
        self._max_age = round(max_age * _SECOND)
        self._clearance, self._heard = float("nan"), 0

    def hear(self, topic: str, message: Any, time: int) -> None:
        """Only scans count."""
        if topic == "/scan":
            self._clearance = outline_clearance(message.ranges, self._lidar, ROBOT)
            self._heard = time

    def step(self, time: int) -> bool:
        """True below the threshold; at the threshold the robot may go on."""
        fresh = time - self._heard <= self._max_age
        return not (fresh and self._clearance >= self._threshold)  # NaN compares false.


def stop_requested(before: bool, *, demanded: bool, manual: bool) -> bool:
    """Whether the safety function requests a stop: from the demand until a person takes over.

    A person with the hand on the switch may move the robot out of a place that is too close.
    """
    return not manual and (before or demanded)


@dataclass(frozen=True, slots=True)
class Intercepted:
    """What the interceptor remembers. Times in nanoseconds, None: never heard."""

    stop: bool = False
    command: Velocity = STANDSTILL
    command_at: int | None = None
    safety_at: int | None = None


@dataclass(frozen=True, slots=True)
class StopHeard:
    """A message on /gwendolen_control."""

    requested: bool


@dataclass(frozen=True, slots=True)
class CommandHeard:
    """A message on /cmd_vel."""

    command: Velocity


@dataclass(frozen=True, slots=True)
class TimerRang:
    """The interceptor's own clock."""


def intercept(
    state: Intercepted,
    heard: StopHeard | CommandHeard | TimerRang,
    time: int,
    options: scenario.Interceptor,
) -> tuple[Intercepted, Velocity | None]:
    """One step: the state after it, and what is said on /cmd_vel_filtered; None: nothing is.

    Args:
        state: before.
        heard: what has come.
        time: nanoseconds.
        options: how it behaves.
    """
    match heard:
        case StopHeard(requested):
            stop = requested or (state.stop and options.latching)
            after = replace(state, stop=stop, safety_at=time)
            speaks = options.at_once and stop and not state.stop
        case CommandHeard(command):
            after, speaks = replace(state, command=command, command_at=time), True
        case TimerRang():
            after, speaks = state, True
    return after, _passed(after, time, options) if speaks else None


def _passed(state: Intercepted, time: int, options: scenario.Interceptor) -> Velocity:
    """The command, or zero: on a stop, and where commands or the safety function are silent."""
    silent = _late(state.command_at, time, options.command_timeout)
    blind = _late(state.safety_at, time, options.safety_timeout)
    return STANDSTILL if state.stop or silent or blind else state.command


def _late(heard: int | None, time: int, timeout: float) -> bool:
    return timeout > 0 and (heard is None or time - heard > round(timeout * _SECOND))
