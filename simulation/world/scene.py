"""The nuclear store as data: walls, shelves, barrels, the robot's outline, the inspection points.

Metres and radians. The room's frame has its origin in one corner, x along the long wall.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simulation.world.motion import Pose


@dataclass(frozen=True, slots=True)
class Box:
    """An upright box: centre, length along its own x, width along its own y, heading `yaw`."""

    name: str
    x: float
    y: float
    length: float
    width: float
    yaw: float = 0.0

    def distance(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Distance from each point to the box seen from above; 0 inside."""
        east, north = np.subtract(x, self.x), np.subtract(y, self.y)
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        along = np.abs(cos * east + sin * north) - self.length / 2
        across = np.abs(cos * north - sin * east) - self.width / 2
        return np.asarray(np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0)))


@dataclass(frozen=True, slots=True)
class Barrel:
    """An upright drum: centre and radius."""

    name: str
    x: float
    y: float
    radius: float = 0.29

    def distance(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Distance from each point to the drum seen from above; 0 inside."""
        to_centre = np.hypot(np.subtract(x, self.x), np.subtract(y, self.y))
        return np.asarray(np.maximum(to_centre - self.radius, 0.0))


@dataclass(frozen=True, slots=True)
class Scene:
    """A room of `length` by `width` with its obstacles, the robot's start and its goals in order.

    The walls are obstacles like the others and stand around the room, not inside it.
    """

    length: float
    width: float
    obstacles: tuple[Box | Barrel, ...]
    start: Pose
    goals: tuple[Pose, ...]

    def distance(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Distance from each point to the nearest obstacle; 0 inside one, +inf if there is none."""
        nearest = np.full(np.broadcast(x, y).shape, np.inf)
        for obstacle in self.obstacles:
            nearest = np.minimum(nearest, obstacle.distance(x, y))
        return nearest


def walls(length: float, width: float, thickness: float = 0.2) -> tuple[Box, ...]:
    """Four walls around a room whose inside is `length` by `width`."""
    outer, half = length + 2 * thickness, thickness / 2
    return (
        Box("wall_south", length / 2, -half, outer, thickness),
        Box("wall_north", length / 2, width + half, outer, thickness),
        Box("wall_west", -half, width / 2, thickness, width),
        Box("wall_east", length + half, width / 2, thickness, width),
    )


ROBOT = Box("robot", 0.0, 0.0, 0.612, 0.580)
"""The Scout Mini's outline in its own frame; the lidar sits at the origin."""

_START = Pose(1.0, 1.0)

STORE = Scene(
    length=10.0,
    width=8.0,
    obstacles=(
        *walls(10.0, 8.0),
        Box("shelf_west", 2.9, 4.7, 0.3, 3.0),
        Box("shelf_south", 6.1, 1.9, 0.3, 3.8),
        Box("shelf_east", 8.3, 5.5, 2.0, 0.3),
        Box("crates", 1.2, 7.1, 1.2, 0.8, 0.2),
        Barrel("barrel_1", 4.3, 1.4),
        Barrel("barrel_2", 4.8, 2.1),
        Barrel("barrel_3", 4.1, 3.6),
        Barrel("barrel_4", 4.6, 5.5),
        Barrel("barrel_5", 5.2, 6.7),
        Barrel("barrel_6", 7.6, 1.0),
        Barrel("barrel_7", 8.5, 3.3),
        Barrel("barrel_8", 0.9, 3.4),
        Barrel("barrel_9", 7.0, 7.2),
        Barrel("barrel_10", 9.3, 7.0),
    ),
    start=_START,
    goals=(Pose(1.9, 5.6), Pose(5.7, 5.0), Pose(8.9, 1.0), _START),
)
"""A store of nuclear material: three points to inspect, then back to the start."""
