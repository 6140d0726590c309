"""A simulated inspection robot with a safety function, recorded as a ROS 2 log.

Importing this package loads neither MuJoCo nor rosbags; `simulation.mission` does.
"""

from importlib.util import find_spec

OPTIONAL_PACKAGES = ("mujoco", "rosbags")


def missing() -> tuple[str, ...]:
    """The optional packages that are not installed; none of them is imported to find out."""
    return tuple(name for name in OPTIONAL_PACKAGES if find_spec(name) is None)
