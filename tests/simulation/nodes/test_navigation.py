import math

import numpy as np
import pytest

from simulation.nodes.navigation import Navigator, PoseError, clearance_grid, plan, pursue
from simulation.world.lidar import Points
from simulation.world.motion import STANDSTILL, BodyVelocity, Pose
from simulation.world.scene import STORE, Box, Scene

SPEED, TURN = 0.4, 0.2

GRID = clearance_grid(STORE)


def test_the_grid_holds_the_clearance_of_its_cells_centres() -> None:
    assert GRID.shape == (200, 160)
    assert GRID[20, 20] == pytest.approx(1.025)  # (1.025, 1.025), the walls are nearest.
    assert GRID[58, 90] == 0.0  # Inside a shelf.


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0.1, 0.32, 0.45])
def test_a_path_stays_clear_of_every_obstacle_and_reaches_its_goal(margin: float) -> None:
    for start, goal in zip((STORE.start, *STORE.goals), STORE.goals, strict=False):
        path = plan(GRID, start, goal, margin)
        assert path is not None
        assert math.dist(path[0], (start.x, start.y)) < 0.05
        assert math.dist(path[-1], (goal.x, goal.y)) < 0.05
        assert np.hypot(*np.diff(path, axis=0).T).max() < 0.0708
        dense = np.concatenate([path[:-1] + share * np.diff(path, axis=0) for share in (0, 0.5)])
        assert STORE.distance(dense[:, 0], dense[:, 1]).min() > margin - 0.01


def test_a_path_in_the_open_is_the_shortest_on_the_grid() -> None:
    path = plan(np.full((100, 100), 9.0), Pose(1.0, 1.0), Pose(3.0, 2.0), 0.3)
    assert path is not None
    length = float(np.hypot(*np.diff(path, axis=0).T).sum())
    assert length == pytest.approx(1.0 * math.sqrt(2) + 1.0)


def test_comfort_buys_room_with_length() -> None:
    start, goal = STORE.goals[1], STORE.goals[2]
    short, wide = plan(GRID, start, goal, 0.32), plan(GRID, start, goal, 0.32, 0.8)
    assert short is not None
    assert wide is not None
    assert STORE.distance(*wide.T).mean() > STORE.distance(*short.T).mean() + 0.01


def test_there_is_no_path_through_a_wall() -> None:
    wall = Box("wall", 1.0, 1.0, 0.2, 2.0)
    grid = clearance_grid(Scene(2.0, 2.0, (wall,), Pose(0.3, 1.0), ()))
    assert plan(grid, Pose(0.3, 1.0), Pose(1.7, 1.0), 0.1) is None


def test_pursuit_drives_straight_at_full_speed_along_a_straight_path() -> None:
    path = np.column_stack([np.arange(0, 2, 0.05), np.zeros(40)])
    assert pursue(path, Pose(0.0, 0.0), SPEED, TURN) == BodyVelocity(SPEED, 0.0)


def test_pursuit_turns_on_the_spot_towards_a_path_behind() -> None:
    path = np.column_stack([np.arange(0, 2, 0.05), np.zeros(40)])
    assert pursue(path, Pose(0.0, 0.0, 2.0), SPEED, TURN) == BodyVelocity(0.0, -TURN)
    assert pursue(path, Pose(0.0, 0.0, -2.0), SPEED, TURN) == BodyVelocity(0.0, TURN)


def test_pursuit_is_never_faster_than_allowed() -> None:
    path = np.array([[1.0, 0.0]])
    yaws = np.linspace(-3.1, 3.1, 63)
    commands = [pursue(path, Pose(0.0, 0.0, yaw), SPEED, TURN) for yaw in yaws]
    assert all(0 <= command.forward <= SPEED for command in commands)
    assert all(abs(command.turn) <= TURN for command in commands)


@pytest.mark.parametrize(
    ("clearance", "speed"), [(1.0, 0.4), (0.6, 0.4), (0.59, 0.14), (0.0, 0.14), (math.nan, 0.14)]
)
def test_the_navigator_is_slow_where_something_is_near_or_nothing_is_known(
    clearance: float, speed: float
) -> None:
    scene = Scene(10.0, 10.0, (), Pose(1.0, 1.0), (Pose(9.0, 1.0),))
    assert Navigator(scene).step(scene.start, clearance).forward == pytest.approx(speed, rel=0.2)


def test_what_it_saw_and_the_map_lacks_is_kept_away_from() -> None:
    navigator = Navigator(Scene(10.0, 10.0, (), Pose(1.0, 5.0), (Pose(9.0, 5.0),)))
    here = Pose(1.0, 5.0, math.pi / 2)  # what is to its right lies ahead on the way
    navigator.replan(here, Points(np.array([0.0]), np.array([-2.0])))
    pose, room = here, math.inf
    while navigator.goal is not None:
        command = navigator.step(pose)
        yaw = pose.yaw + command.turn * 0.1
        step = command.forward * 0.1
        pose = Pose(pose.x + step * math.cos(yaw), pose.y + step * math.sin(yaw), yaw)
        room = min(room, math.dist((pose.x, pose.y), (3.0, 5.0)))
    assert 0.45 < room < 1.0


@pytest.mark.slow
def test_the_pose_error_wanders_by_some_centimetres_and_slowly() -> None:
    error, seen = PoseError(1), []
    for _ in range(50 * 600):
        error.step(0.02)
        seen.append(error.estimate(Pose(0.0, 0.0)))
    drift = np.array([(pose.x, pose.y) for pose in seen])
    assert np.std(drift) == pytest.approx(0.045, rel=0.25)
    assert np.abs(np.diff(drift, axis=0)).max() < 0.03
    assert all(pose.yaw == 0.0 for pose in seen)


def test_the_navigator_takes_its_goals_in_order_and_then_stands() -> None:
    navigator = Navigator(STORE)
    for count, goal in enumerate(STORE.goals):
        assert (navigator.reached, navigator.goal) == (count, goal)
        assert navigator.step(goal) == STANDSTILL
    assert navigator.goal is None
    assert navigator.step(STORE.start) == STANDSTILL


@pytest.mark.slow
def test_the_navigator_leads_a_perfect_robot_to_every_goal() -> None:
    navigator, pose = Navigator(STORE), STORE.start
    for _ in range(3000):
        command = navigator.step(pose)
        yaw = pose.yaw + command.turn * 0.1
        step = command.forward * 0.1
        pose = Pose(pose.x + step * math.cos(yaw), pose.y + step * math.sin(yaw), yaw)
    assert navigator.reached == len(STORE.goals)
