"""The safety function: how far obstacles are from the robot's outline, and who may drive.

No input, no output, no clock: each step takes a value and gives a value.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulation.lidar import Lidar
from simulation.motion import STANDSTILL, Velocity
from simulation.scene import Box

SAFE_DISTANCE = 0.05
"""Metres from the outline; nearer is too close (R1 of the inspection experiment)."""


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
    """What decides, scan by scan, whether the robot must stop; a monitor may stand here."""

    def step(self, clearance: float) -> bool:
        """True if the robot must stop now; `clearance` in metres, NaN where unknown."""
        ...


@dataclass(frozen=True, slots=True)
class TooClose:
    """R1 by hand: stop when the clearance is below `threshold` metres, or unknown."""

    threshold: float = SAFE_DISTANCE

    def step(self, clearance: float) -> bool:
        """True below the threshold; at the threshold the robot may go on."""
        return not clearance >= self.threshold  # NaN compares false: unknown stops.


class SafetyFunction:
    """Keeps the stop that its decision demands until a person releases it.

    After a release the robot is still too close, so the function lets it move until the clearance
    has reached `rearm_at` metres or the person says that the manoeuvre is over.
    """

    def __init__(self, decision: Decision, rearm_at: float = 2 * SAFE_DISTANCE) -> None:
        self._decision = decision
        self._rearm_at = rearm_at
        self._armed = True
        self._stop = False

    @property
    def stop_requested(self) -> bool:
        """True from the demand to stop until the release."""
        return self._stop

    def step(self, clearance: float) -> bool:
        """Take one scan's clearance in metres; True if the robot has to stand still now."""
        demanded = self._decision.step(clearance)
        self._armed = self._armed or clearance >= self._rearm_at
        self._stop = self._stop or (self._armed and demanded)
        return self._stop

    def release(self) -> None:
        """A person takes over and may move the robot although it is too close."""
        self._stop = False
        self._armed = False

    def rearm(self) -> None:
        """The person's manoeuvre is over; from the next step on every demand counts again."""
        self._armed = True


@dataclass(frozen=True, slots=True)
class Interceptor:
    """Stands between the planner and the wheels: forwards the last command, or zero on stop."""

    stop_requested: bool = False
    command: Velocity = STANDSTILL

    def hear_stop(self, requested: bool) -> "Interceptor":
        """On `/gwendolen_control`."""
        return replace(self, stop_requested=requested)

    def hear_command(self, command: Velocity) -> "Interceptor":
        """On `/cmd_vel`."""
        return replace(self, command=command)

    def output(self) -> Velocity:
        """For `/cmd_vel_filtered`, on every tick of the timer and at once when a stop comes."""
        return STANDSTILL if self.stop_requested else self.command
