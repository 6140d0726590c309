"""Somebody who walks into the room, stands there and walks back."""

import math

from simulation.world.motion import Pose
from simulation.world.scenario import Walker
from simulation.world.scene import Barrel


class WalkerPath:
    """Where the walker is, tick by tick."""

    def __init__(self, walker: Walker) -> None:
        self._walker = walker
        self._began: float | None = None
        self._length = math.dist(walker.start, walker.end)

    @property
    def obstacle(self) -> Barrel:
        """The walker before the walk."""
        return Barrel("walker", *self._walker.start, self._walker.radius)

    def step(self, time: float, robot: Pose) -> tuple[float, float]:
        """The place in metres; `time` in seconds, `robot` where the robot really is."""
        walker = self._walker
        if self._began is None and math.dist((robot.x, robot.y), walker.near) < walker.within:
            self._began = time
        if self._began is None:
            return walker.start
        there = self._length / walker.speed
        since = time - self._began
        share = (
            min(1.0, since / there) if since < there + walker.stays else self._back(since, there)
        )
        (x, y), (end_x, end_y) = walker.start, walker.end
        return x + share * (end_x - x), y + share * (end_y - y)

    def _back(self, since: float, there: float) -> float:
        return max(0.0, 1.0 - (since - there - self._walker.stays) / there)
