"""Where the robot is and how fast it moves, in the plane."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Pose:
    """Position in metres in the room's frame; yaw in radians, 0 along x, growing to the left."""

    x: float
    y: float
    yaw: float = 0.0


@dataclass(frozen=True, slots=True)
class BodyVelocity:
    """Body-frame velocity: `forward` in m/s (negative backwards), `turn` in rad/s, left positive.

    Both what is asked for (a ROS Twist) and what is measured.
    """

    forward: float
    turn: float


STANDSTILL = BodyVelocity(0.0, 0.0)
