import math

import pytest

from simulation.world.motion import Pose
from simulation.world.scene import ROBOT, STORE, Barrel, Box, Scene


def test_distance_to_a_turned_box_is_measured_in_its_own_frame() -> None:
    box = Box("shelf", 1.0, 2.0, length=4.0, width=1.0, yaw=math.pi / 2)
    assert box.distance(1.0, 5.0) == pytest.approx(1.0)
    assert box.distance(2.0, 2.0) == pytest.approx(0.5)
    assert box.distance(1.5 + 3.0, 4.0 + 4.0) == pytest.approx(5.0)
    assert box.distance(1.2, 3.9) == 0.0


def test_distance_to_a_barrel_is_to_its_skin() -> None:
    barrel = Barrel("drum", 0.0, 0.0, radius=0.5)
    assert barrel.distance(3.0, 4.0) == pytest.approx(4.5)
    assert barrel.distance(0.1, 0.1) == 0.0


def test_a_scene_knows_the_nearest_obstacle_and_an_empty_one_none() -> None:
    obstacles = (Barrel("a", 0.0, 0.0, 1.0), Barrel("b", 10.0, 0.0, 1.0))
    scene = Scene(10.0, 10.0, obstacles, Pose(5.0, 5.0), ())
    assert scene.distance([3.0, 6.0], [0.0, 0.0]).tolist() == [2.0, 3.0]
    assert Scene(1.0, 1.0, (), Pose(0.0, 0.0), ()).distance(0.0, 0.0) == math.inf


def test_start_and_goals_of_the_store_leave_room_for_the_robot() -> None:
    half_diagonal = math.hypot(ROBOT.length, ROBOT.width) / 2
    for place in (STORE.start, *STORE.goals):
        assert STORE.distance(place.x, place.y) > half_diagonal


def test_the_obstacles_of_the_store_have_names_of_their_own() -> None:
    names = [obstacle.name for obstacle in STORE.obstacles]
    assert len(set(names)) == len(names)
