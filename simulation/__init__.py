"""A simulated inspection robot with a safety function, recorded as a ROS log.

Input is a scenario and a seed. Output is an MCAP file, and pictures. Importing this package loads
none of its optional packages; `simulation.mission` does.
"""

from importlib.util import find_spec

__version__ = "0.2.0"
"""Of the simulation: another one gives other messages for the same seed."""

OPTIONAL_PACKAGES = ("matplotlib", "mujoco", "rosbags")


def missing() -> tuple[str, ...]:
    """The optional packages that are not installed; none of them is imported to find out."""
    return tuple(name for name in OPTIONAL_PACKAGES if find_spec(name) is None)
