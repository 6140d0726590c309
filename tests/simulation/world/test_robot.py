import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from simulation.world.lidar import Lidar
from simulation.world.motion import STANDSTILL, BodyVelocity, Pose
from simulation.world.robot import PHYSICS_STEP, Robot
from simulation.world.scene import STORE, Barrel, Box, Scene

QUIET = Lidar(noise=0.0)
TURNED = (
    Box("crate", 2.0, 1.5, 1.0, 0.4, 0.7),
    Box("shelf", -1.5, 0.5, 0.3, 3.0, -0.2),
    Barrel("drum", 0.5, -2.0, 0.4),
)


ORIGIN = Pose(0.0, 0.0)


def alone(*obstacles: Box | Barrel, start: Pose = ORIGIN) -> Scene:
    return Scene(10.0, 10.0, obstacles, start, ())


def cast(scene: Scene, pose: Pose) -> NDArray[np.float64]:
    """Slow and obvious: each beam against each wall of a box and each circle."""
    ranges = []
    for beam in range(360):
        turn = pose.yaw + math.radians(beam - 180)
        hits = [hit for obstacle in scene.obstacles for hit in hit_by(obstacle, pose, turn)]
        ranges.append(min(hits, default=math.inf))
    return np.array([value if value <= 12.0 else math.inf for value in ranges])


def hit_by(obstacle: Box | Barrel, pose: Pose, turn: float) -> Iterator[float]:
    x, y = pose.x - obstacle.x, pose.y - obstacle.y
    if isinstance(obstacle, Barrel):
        middle = -(x * math.cos(turn) + y * math.sin(turn))
        under_root = middle**2 - (x**2 + y**2 - obstacle.radius**2)
        if middle > 0 and under_root >= 0:
            yield middle - math.sqrt(under_root)
        return
    cos, sin = math.cos(obstacle.yaw), math.sin(obstacle.yaw)
    at = (cos * x + sin * y, cos * y - sin * x)
    to = (math.cos(turn - obstacle.yaw), math.sin(turn - obstacle.yaw))
    half = (obstacle.length / 2, obstacle.width / 2)
    for axis, other in ((0, 1), (1, 0)):
        for side in (-half[axis], half[axis]):
            if abs(to[axis]) > 1e-12:
                distance = (side - at[axis]) / to[axis]
                if distance > 0 and abs(at[other] + distance * to[other]) <= half[other]:
                    yield distance


@pytest.mark.parametrize(
    "scene",
    [
        alone(*TURNED),
        alone(*TURNED, start=Pose(0.3, 0.4, 2.1)),
        STORE,
        replace(STORE, start=Pose(5.3, 4.4, -1.0)),
        replace(STORE, start=Pose(8.9, 1.0, 3.0)),
    ],
    ids=["three", "three, turned", "start", "middle", "corner"],
)
def test_the_lidar_agrees_with_an_independent_ray_caster(scene: Scene) -> None:
    seen = Robot(scene, QUIET, seed=1).scan()
    np.testing.assert_allclose(seen, cast(scene, scene.start), atol=2e-6)


def test_the_lidar_still_agrees_after_the_robot_has_moved() -> None:
    robot = Robot(STORE, QUIET, seed=1)
    robot.drive(BodyVelocity(0.3, 0.4), 800)
    np.testing.assert_allclose(robot.scan(), cast(STORE, robot.pose), atol=2e-6)


def test_an_empty_room_and_one_out_of_reach_read_infinite_and_the_robot_does_not_see_itself() -> (
    None
):
    assert np.isposinf(Robot(alone(), QUIET, seed=1).scan()).all()
    far = alone(Box("wall", 13.0, 0.0, 1.0, 5.0))
    assert np.isposinf(Robot(far, Lidar(), seed=1).scan()).all()


def test_what_is_nearer_than_the_lidar_can_measure_reads_minus_infinite() -> None:
    scan = Robot(alone(Box("pole", 0.105, 0.0, 0.01, 0.01)), QUIET, seed=1).scan()
    assert scan[180] == -np.inf
    assert np.isposinf(scan[190:]).all()


def test_noise_has_the_stated_spread() -> None:
    robot = Robot(STORE, Lidar(), seed=1)
    errors = np.concatenate([robot.scan() - cast(STORE, STORE.start) for _ in range(10)])
    assert np.std(errors) == pytest.approx(0.008, rel=0.05)


def test_noise_is_the_same_for_a_seed_and_another_for_another() -> None:
    first, again, other = (Robot(STORE, Lidar(), seed).scan() for seed in (1, 1, 2))
    assert first.tolist() == again.tolist()
    assert first.tolist() != other.tolist()


def test_the_robot_follows_its_command() -> None:
    robot = Robot(alone(), QUIET, seed=1)
    robot.drive(BodyVelocity(0.4, 0.0), 1000)
    assert robot.velocity.forward == pytest.approx(0.4, abs=0.01)
    assert robot.pose.x == pytest.approx(0.4 * 1000 * PHYSICS_STEP, abs=0.05)
    robot.drive(BodyVelocity(0.0, 0.5), 1000)
    assert robot.velocity.turn == pytest.approx(0.5, abs=0.01)
    assert robot.pose.yaw == pytest.approx(0.5 * 1000 * PHYSICS_STEP, abs=0.1)


def test_braking_is_limited_by_the_force_of_the_motors() -> None:
    robot = Robot(alone(), QUIET, seed=1)
    robot.drive(BodyVelocity(0.4, 0.0), 1000)
    before = robot.pose.x
    robot.drive(STANDSTILL, 500)
    assert robot.velocity.forward == pytest.approx(0.0, abs=0.001)
    assert 0.4**2 / (2 * 60 / 23) < robot.pose.x - before < 0.05


def test_clearance_is_between_outline_and_obstacle() -> None:
    ahead = Box("box", 1.306, 0.0, 1.0, 1.0)
    assert Robot(alone(ahead), QUIET, 1).clearance() == pytest.approx(0.5, abs=1e-4)
    aside = Barrel("drum", 0.0, -1.0, 0.29)
    assert Robot(alone(aside), QUIET, 1).clearance() == pytest.approx(0.42, abs=1e-4)
    assert Robot(alone(), QUIET, 1).clearance() == 1.0


def test_clearance_is_that_of_this_moment_while_the_robot_moves() -> None:
    robot = Robot(alone(Box("box", 1.306, 0.0, 1.0, 1.0)), QUIET, 1)
    robot.drive(BodyVelocity(0.4, 0.0), 400)
    assert robot.clearance() == pytest.approx(0.5 - robot.pose.x, abs=1e-4)


def test_the_robot_touches_what_it_is_driven_into() -> None:
    robot = Robot(alone(Box("box", 1.306, 0.0, 1.0, 1.0)), QUIET, 1)
    assert not robot.touching()
    robot.drive(BodyVelocity(0.4, 0.0), 1000)
    assert robot.touching()
    assert robot.clearance() < 0.001
    assert robot.pose.x < 0.51


def test_a_walker_is_seen_where_it_is_and_is_as_hard_as_anything() -> None:
    robot = Robot(alone(), QUIET, 1, Barrel("walker", 5.0, 0.0, 0.25))
    assert robot.scan()[180] == pytest.approx(4.75, abs=1e-5)
    robot.place_walker(1.0, 0.0)
    robot.drive(STANDSTILL, 1)
    assert robot.scan()[180] == pytest.approx(0.75, abs=1e-5)
    assert robot.clearance() == pytest.approx(1.0 - 0.25 - 0.306, abs=1e-4)
    robot.drive(BodyVelocity(0.4, 0.0), 1500)
    assert robot.touching()
    assert robot.pose.x < 0.46
