"""The operator: lets a stopped robot stand, then drives it out of the tight place."""

import math
from itertools import product

from simulation.world.lidar import Points
from simulation.world.motion import BodyVelocity
from simulation.world.scene import Box

STAND = 3.0
"""Seconds that a stopped robot stands before the operator releases it."""

MANOEUVRE = 2.0
"""Seconds that the operator drives."""

_STANDING = 0.01  # m/s and rad/s; slower counts as standing.
_CHOICES = [
    BodyVelocity(forward, turn) for forward, turn in product((-0.14, 0.14), (0.0, -0.2, 0.2))
]
_LOOK_STEP = 0.1
_ENOUGH = 0.40


def way_out(points: Points, outline: Box) -> BodyVelocity:
    """The slow manoeuvre that brings nothing nearer and gains the most room.

    Each choice is held for `MANOEUVRE` seconds in thought; clearance beyond 0.4 m gains nothing.
    The first of equals wins, and straight back comes first.
    """
    return max(_CHOICES, key=lambda choice: _merit(_clearances(choice, points, outline)))


def _merit(clearances: list[float]) -> tuple[float, float]:
    """First not to lose a centimetre on the way, then to have room at the end."""
    lost = max(0.0, clearances[0] - min(clearances))
    return -round(lost, 2), sum(clearances)


def _clearances(choice: BodyVelocity, points: Points, outline: Box) -> list[float]:
    """Metres from outline to points, at most 0.4: before the manoeuvre and after each step."""
    x = y = yaw = 0.0
    clearances = []
    for _ in range(round(MANOEUVRE / _LOOK_STEP) + 1):
        moved = Box(outline.name, x, y, outline.length, outline.width, yaw)
        clearances.append(float(moved.distance(points.x, points.y).min(initial=_ENOUGH)))
        yaw += choice.turn * _LOOK_STEP
        x += choice.forward * math.cos(yaw) * _LOOK_STEP
        y += choice.forward * math.sin(yaw) * _LOOK_STEP
    return clearances


class OperatorNode:
    """A person beside the robot, asked at every control tick."""

    def __init__(self, outline: Box) -> None:
        self._outline = outline
        self._standing_since: float | None = None
        self._command: BodyVelocity | None = None
        self._until = 0.0

    def step(
        self, time: float, stop_requested: bool, velocity: BodyVelocity, points: Points
    ) -> BodyVelocity | None:
        """What the operator commands, or None while the planner is in charge.

        Args:
            time: simulated seconds.
            stop_requested: is the safety function stopping the robot?
            velocity: how fast the robot really moves.
            points: what the last scan saw.
        """
        if stop_requested:
            self._command = None
            self._wait(time, velocity)
            if self._standing_since is not None and time - self._standing_since >= STAND:
                self._standing_since = None
                self._command, self._until = way_out(points, self._outline), time + MANOEUVRE
        elif time >= self._until:
            self._command = None
        return self._command

    def _wait(self, time: float, velocity: BodyVelocity) -> None:
        """Note since when the robot stands."""
        if abs(velocity.forward) > _STANDING or abs(velocity.turn) > _STANDING:
            self._standing_since = None
        elif self._standing_since is None:
            self._standing_since = time
