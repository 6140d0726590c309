"""The safety system as pure functions: how near things are, who must stop, what the wheels hear.

No input, no output, no clock: each step takes values and gives values.
"""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from simulation.world.lidar import Lidar
from simulation.world.scene import ROBOT, Box

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
        nothing is known, because no beam gave an answer. Single NaN beams are passed over, and so
        are finite ranges beyond `range_max`.

    Source: REP 117, Informational Distance Measurements.
    """
    if np.any(np.isneginf(ranges) | ((ranges > 0) & (ranges < np.float32(lidar.range_min)))):
        return 0.0
    points = lidar.points(ranges)
    if len(points.x):
        return float(outline.distance(points.x, points.y).min())
    return float("inf") if np.any(np.isposinf(ranges)) else float("nan")


class Decision(Protocol):
    """What decides whether the robot must stop: the monitor of a requirement stands here."""

    def hear(self, topic: str, message: Any, time: int) -> None:
        """A message of /scan or /odom has arrived; `time` in nanoseconds."""
        ...

    def step(self, time: int) -> bool:
        """True if the robot must stop now; asked at each scan, and when none comes."""
        ...


class Agent(Decision, Protocol):
    """A decision of another program, which tells what it believes and does."""

    @property
    def speaks(self) -> bool:
        """Whether it answers; a safety function that does not is silent."""
        ...

    def told(self) -> Sequence[str]:
        """What it has told of itself since the last call."""
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


class InterceptionNode(Protocol):
    """What stands between commands and wheels: the emitted interceptor stands here.

    What it says goes where `Wheels` leads, before the call returns.
    """

    def hear_stop(self, message: Any) -> None:
        """A message on /gwendolen_control."""
        ...

    def hear_command(self, message: Any) -> None:
        """A message on /cmd_vel."""
        ...

    def ring(self) -> None:
        """A tick of its timer."""
        ...


Wheels = Callable[[Sequence[float]], None]
"""Takes what is said to the wheels: m/s along x, y, z, and rad/s around them."""

Interceptor = Callable[[Wheels], InterceptionNode]
"""Makes one."""
