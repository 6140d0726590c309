"""The planner: A* on a grid, pursuit of its path, and a pose estimate that drifts.

It stands for amcl and move_base. It knows the map, and what it saw where the robot was stopped.
"""

import heapq
import math
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from simulation.world.lidar import Points
from simulation.world.motion import STANDSTILL, BodyVelocity, Pose
from simulation.world.scenario import PlannerBehaviour
from simulation.world.scene import Scene

RESOLUTION = 0.05
"""Metres per cell."""

_CAUTIOUS_MARGIN = 0.55
_TIGHT_MARGINS = (0.45, 0.32, 0.2, 0.1, 0.0)
_LOOKAHEAD = 0.40
_ARRIVED = 0.15
_COMFORT = 0.3
_SEEN_WITHIN = 2.5
_UNMAPPED = 0.2

Cell = tuple[int, int]
_NEIGHBOURS = [(i, j, math.hypot(i, j)) for i, j in product((-1, 0, 1), repeat=2) if i or j]


def clearance_grid(scene: Scene) -> NDArray[np.float64]:
    """Metres from the centre of each cell (x, y) to the nearest obstacle; 0 inside one."""
    columns, rows = round(scene.length / RESOLUTION), round(scene.width / RESOLUTION)
    x, y = (np.arange(columns) + 0.5) * RESOLUTION, (np.arange(rows) + 0.5) * RESOLUTION
    return scene.distance(*np.meshgrid(x, y, indexing="ij"))


def plan(
    clearance: NDArray[np.float64],
    start: Pose,
    goal: Pose,
    margin: float,
    comfort: float = 0.0,
) -> NDArray[np.float64] | None:
    """The shortest way over the grid (A*), eight neighbours to a cell.

    Args:
        clearance: as `clearance_grid` gives it.
        start: where the way begins; may be nearer to an obstacle than `margin`.
        goal: where it ends.
        margin: metres; a cell must have more clearance than this.
        comfort: metres; cells with less clearance than this cost up to some times more.

    Returns:
        Shape (n, 2), n >= 1: the centres of the cells from start to goal, in metres; None if
        there is no way.
    """
    first, last = _cell(start), _cell(goal)
    usable = (clearance > margin).tolist()
    price = (1.0 + 3.0 * np.maximum(0.0, comfort - clearance)).tolist()
    columns, rows = clearance.shape
    cost, before = {first: 0.0}, dict[Cell, Cell]()
    queue, done = [(0.0, first)], set[Cell]()
    while queue:
        _, here = heapq.heappop(queue)
        if here == last:
            return _way(before, last)
        if here in done:
            continue
        done.add(here)
        for i, j, length in _NEIGHBOURS:
            there = (here[0] + i, here[1] + j)
            if not (0 <= there[0] < columns and 0 <= there[1] < rows):
                continue
            if not usable[there[0]][there[1]]:
                continue
            total = cost[here] + length * price[there[0]][there[1]]
            if total < cost.get(there, math.inf):
                cost[there], before[there] = total, here
                heapq.heappush(queue, (total + math.dist(there, last), there))
    return None


def _cell(pose: Pose) -> Cell:
    return int(pose.x // RESOLUTION), int(pose.y // RESOLUTION)


def _way(before: dict[Cell, Cell], last: Cell) -> NDArray[np.float64]:
    cells = [last]
    while cells[-1] in before:
        cells.append(before[cells[-1]])
    return (np.array(cells[::-1]) + 0.5) * RESOLUTION


def pursue(path: NDArray[np.float64], pose: Pose, speed: float, turn: float) -> BodyVelocity:
    """Steer at the point of the path that lies some 0.4 m ahead (pure pursuit).

    Args:
        path: shape (n, 2), n >= 1, metres.
        pose: where the robot believes it is.
        speed: at most, m/s.
        turn: at most, rad/s.

    Returns:
        Slower the more the point lies to the side, and turning on the spot when it lies too far
        off for the robot to turn towards it on the way.
    """
    nearest = int(np.hypot(path[:, 0] - pose.x, path[:, 1] - pose.y).argmin())
    x, y = _ahead(path[nearest:], _LOOKAHEAD)
    bearing = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, 2 * math.pi)
    widest = min(1.2, 2.0 * turn)
    share = max(0.0, 1.0 - abs(bearing) / widest)
    return BodyVelocity(speed * share, max(-turn, min(turn, 2.2 * bearing)))


def _ahead(path: NDArray[np.float64], distance: float) -> tuple[float, float]:
    """The first corner of the path at least `distance` metres along it, or its end."""
    points = path.tolist()
    for here, there in pairwise(points):
        distance -= math.dist(here, there)
        if distance <= 0:
            return there[0], there[1]
    return points[-1][0], points[-1][1]


class PoseError:
    """The estimate's error in x and y: it wanders, some 4.5 cm in each, and is pulled back to 0."""

    def __init__(self, seed: int, spread: float = 0.045, pull: float = 0.3) -> None:
        """`spread` in metres (standard deviation in the long run), `pull` in 1/s."""
        self._random = np.random.default_rng([seed, 2])
        self._spread, self._pull = spread, pull
        self._x = self._y = 0.0

    def step(self, seconds: float) -> None:
        """Let time pass."""
        decay = math.exp(-self._pull * seconds)
        wander = self._spread * math.sqrt(1 - decay * decay)
        x, y = self._random.normal(0.0, wander, 2)
        self._x, self._y = decay * self._x + float(x), decay * self._y + float(y)

    def estimate(self, pose: Pose) -> Pose:
        """Where the robot believes it is."""
        return Pose(pose.x + self._x, pose.y + self._y, pose.yaw)


class Navigator:
    """Leads the robot from goal to goal.

    Args:
        scene: as the map shows it.
        planner: how it plans and drives.
    """

    def __init__(self, scene: Scene, planner: PlannerBehaviour = PlannerBehaviour()) -> None:  # noqa: B008 - frozen
        self._map = clearance_grid(scene)
        self._clearance = self._map
        self._options = planner
        self._goals: Sequence[Pose] = scene.goals
        self._reached = 0
        self._margin = planner.margin
        self._path: NDArray[np.float64] | None = None

    @property
    def map(self) -> NDArray[np.float64]:
        """Metres from each cell (x, y) to the nearest mapped obstacle."""
        return self._map

    @property
    def reached(self) -> int:
        """How many goals are behind."""
        return self._reached

    @property
    def goal(self) -> Pose | None:
        """The goal in force; None when all are reached."""
        return self._goals[self._reached] if self._reached < len(self._goals) else None

    def step(self, estimate: Pose, clearance: float = math.inf) -> BodyVelocity:
        """The next command; standstill at a goal and after the last.

        Args:
            estimate: where the robot believes it is.
            clearance: metres to the nearest thing that it sees; NaN where it sees nothing at all.
        """
        if self.goal is None:
            return STANDSTILL
        if math.hypot(self.goal.x - estimate.x, self.goal.y - estimate.y) < _ARRIVED:
            self._reached += 1
            self._margin, self._path = self._options.margin, None
            return STANDSTILL
        if self._path is None:
            self._path = self._planned(estimate, self.goal)
        if self._path is None:
            return STANDSTILL
        free = clearance >= self._options.slow_below  # NaN compares false: unknown is slow
        speed = self._options.speed if free else min(self._options.slow, self._options.speed)
        return pursue(self._path, estimate, speed, self._options.turn)

    def replan(self, estimate: Pose, points: Points) -> None:
        """The robot was stopped and moved: keep away from what it sees, up to the next goal.

        Args:
            estimate: where the robot believes it is.
            points: what the last scan saw, in the robot's frame.
        """
        self._clearance = np.minimum(self._clearance, self._away_from(estimate, points))
        self._margin, self._path = _CAUTIOUS_MARGIN, None

    def _away_from(self, estimate: Pose, points: Points) -> NDArray[np.float64]:
        """Metres from each cell to what is seen near the robot and is not on the map."""
        cos, sin = math.cos(estimate.yaw), math.sin(estimate.yaw)
        east = estimate.x + cos * points.x - sin * points.y
        north = estimate.y + sin * points.x + cos * points.y
        columns, rows = self._map.shape
        i = np.clip((east / RESOLUTION).astype(int), 0, columns - 1)
        j = np.clip((north / RESOLUTION).astype(int), 0, rows - 1)
        new = (np.hypot(points.x, points.y) < _SEEN_WITHIN) & (self._map[i, j] > _UNMAPPED)
        nearest = np.full(self._map.shape, np.inf)
        x = (np.arange(columns) + 0.5)[:, None] * RESOLUTION
        y = (np.arange(rows) + 0.5)[None, :] * RESOLUTION
        for at_x, at_y in zip(east[new].tolist(), north[new].tolist(), strict=True):
            nearest = np.minimum(nearest, np.hypot(x - at_x, y - at_y))
        return nearest

    def _planned(self, estimate: Pose, goal: Pose) -> NDArray[np.float64] | None:
        """The way with the widest margin that there is one for; as the map has it, at the last."""
        for clearance in (self._clearance, self._map):
            for margin in (self._margin, *_TIGHT_MARGINS):
                if margin <= self._margin:
                    path = plan(clearance, estimate, goal, margin, self._margin + _COMFORT)
                    if path is not None:
                        return path
        return None
