import numpy as np
import pytest

from simulation.nodes.recovery import OperatorNode, way_out
from simulation.world.lidar import Points
from simulation.world.motion import STANDSTILL, BodyVelocity
from simulation.world.scene import ROBOT

BACK, AHEAD = BodyVelocity(-0.14, 0.0), BodyVelocity(0.14, 0.0)
MOVING = BodyVelocity(0.2, 0.0)


def points(*places: tuple[float, float]) -> Points:
    x, y = np.array(places).reshape(-1, 2).T
    return Points(x, y)


@pytest.mark.parametrize(
    ("seen", "expected"),
    [
        (points((0.34, 0.0)), BACK),
        (points((-0.34, 0.0)), AHEAD),
        (points((0.34, 0.0), (-0.8, 0.0)), BACK),
        (points(), BACK),
    ],
    ids=["in front", "behind", "in front, and farther behind", "nowhere"],
)
def test_the_way_out_is_away_from_what_is_near(seen: Points, expected: BodyVelocity) -> None:
    assert way_out(seen, ROBOT) == expected


def test_the_way_out_turns_away_from_what_is_at_a_corner_behind() -> None:
    # Something left behind and a wall in front: back out, tail to the right (turn left).
    choice = way_out(points((0.34, 0.0), (-0.45, 0.35)), ROBOT)
    assert choice.forward < 0
    assert choice.turn > 0


def test_the_way_out_swings_no_corner_into_what_is_beside_the_robot() -> None:
    # Turning would gain room from what is ahead, but only past the thing at the left flank.
    choice = way_out(points((0.34, 0.0), (0.28, 0.30), (-0.28, 0.30)), ROBOT)
    assert choice == BACK


def test_the_operator_waits_until_the_robot_has_stood_for_three_seconds() -> None:
    operator, near = OperatorNode(ROBOT), points((0.34, 0.0))
    assert operator.step(0.0, False, MOVING, near) is None
    assert operator.step(1.0, True, MOVING, near) is None
    assert operator.step(2.0, True, STANDSTILL, near) is None
    assert operator.step(4.9, True, STANDSTILL, near) is None
    assert operator.step(5.0, True, STANDSTILL, near) == BACK


def test_a_robot_that_moves_again_is_waited_for_anew() -> None:
    operator, near = OperatorNode(ROBOT), points((0.34, 0.0))
    for time, velocity in ((0.0, STANDSTILL), (2.0, MOVING), (2.1, STANDSTILL)):
        assert operator.step(time, True, velocity, near) is None
    assert operator.step(5.0, True, STANDSTILL, near) is None
    assert operator.step(5.2, True, STANDSTILL, near) == BACK


def test_the_manoeuvre_is_kept_for_two_seconds_and_then_the_planner_has_the_robot_back() -> None:
    operator = OperatorNode(ROBOT)
    operator.step(0.0, True, STANDSTILL, points((0.34, 0.0)))
    assert operator.step(3.0, True, STANDSTILL, points((0.34, 0.0))) == BACK
    assert operator.step(4.9, False, MOVING, points((-0.34, 0.0))) == BACK
    assert operator.step(5.0, False, MOVING, points((-0.34, 0.0))) is None


def test_a_stop_ends_the_manoeuvre() -> None:
    operator = OperatorNode(ROBOT)
    operator.step(0.0, True, STANDSTILL, points((0.34, 0.0)))
    assert operator.step(3.0, True, STANDSTILL, points((0.34, 0.0))) == BACK
    assert operator.step(3.5, True, MOVING, points((-0.34, 0.0))) is None
    assert operator.step(4.0, True, STANDSTILL, points((-0.34, 0.0))) is None
    assert operator.step(7.0, True, STANDSTILL, points((-0.34, 0.0))) == AHEAD
