"""The fields of well-known ROS messages that are useful as signals, with their units.

Sources: the comments in the definitions of common_interfaces (sensor_msgs, geometry_msgs,
nav_msgs, std_msgs) and ackermann_msgs; REP 103 (metres, radians, seconds where a definition says
nothing else); REP 117 (readings out of range).
"""

from __future__ import annotations

from collections.abc import Mapping

from fretish.classes.frozen import dataclass

_REP_117 = '{ nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }'


@dataclass(frozen=True, slots=True)
class NumberField:
    """A field of a message, with the name, unit and range of its signal."""

    field: str
    name: str
    """The last part of the signal's name."""
    unit: str = ""
    """The unit; empty: a plain number, or the definition leaves the unit open."""
    reduce: str = ""
    valid: str = ""
    invalid: str = ""
    """The key `invalid` as an inline table of TOML."""
    note: str = ""


def _planar(prefix: str) -> tuple[NumberField, ...]:
    """The fields of a geometry_msgs/Twist: m/s and rad/s, x forward and z up (REP 103)."""
    return (
        NumberField(f"{prefix}linear.x", "vx", "m/s"),
        NumberField(f"{prefix}linear.y", "vy", "m/s"),
        NumberField(f"{prefix}angular.z", "wz", "rad/s"),
    )


def _place(prefix: str) -> tuple[NumberField, ...]:
    """The fields of a geometry_msgs/Pose."""
    return tuple(NumberField(f"{prefix}position.{axis}", axis, "m") for axis in "xyz")


def _force(prefix: str) -> tuple[NumberField, ...]:
    """The fields of a geometry_msgs/Wrench."""
    return (
        *(NumberField(f"{prefix}force.{axis}", f"f{axis}", "N") for axis in "xyz"),
        *(NumberField(f"{prefix}torque.{axis}", f"t{axis}", "Nm") for axis in "xyz"),
    )


def _accelerations(prefix: str) -> tuple[NumberField, ...]:
    return tuple(NumberField(f"{prefix}linear.{axis}", f"a{axis}", "m/s^2") for axis in "xyz")


def _steered(prefix: str) -> tuple[NumberField, ...]:
    return (
        NumberField(f"{prefix}speed", "speed", "m/s"),
        NumberField(f"{prefix}steering_angle", "steering", "rad"),
    )


_PLAIN = (NumberField("data", "", note="a plain number: the type states no unit"),)
_FLAG = (NumberField("data", "", note="true or false: its name alone is an expression"),)
_WORD = (NumberField("data", "", note="the values in this log; add the missing ones"),)

QUANTITIES: Mapping[str, tuple[NumberField, ...]] = {
    "sensor_msgs/LaserScan": (
        NumberField(
            "ranges[:]",
            "min",
            "m",
            reduce="min",
            valid="range_min <= x and x <= range_max",
            invalid=_REP_117,
            note="from the sensor to the nearest obstacle; `outline` measures from the robot's "
                "outline",
        ),
    ),
    "sensor_msgs/Range": (
        NumberField("range", "", "m", valid="min_range <= x and x <= max_range", invalid=_REP_117),
    ),
    "sensor_msgs/BatteryState": (
        NumberField("voltage", "voltage", "V"),
        NumberField("current", "current", "A", note="below 0 while it discharges; NaN: unmeasured"),
        NumberField("percentage", "percentage", note="from 0 to 1, or write 20 %; NaN: unmeasured"),
    ),
    "sensor_msgs/Imu": (
        *(NumberField(f"angular_velocity.{axis}", f"w{axis}", "rad/s") for axis in "xyz"),
        *(NumberField(f"linear_acceleration.{axis}", f"a{axis}", "m/s^2") for axis in "xyz"),
    ),
    "sensor_msgs/Temperature": (
        NumberField("temperature", "", note="degrees Celsius, which is not a unit of fretc: a "
            "plain number"),
    ),
    "sensor_msgs/FluidPressure": (NumberField("fluid_pressure", "", "Pa"),),
    "sensor_msgs/RelativeHumidity": (NumberField("relative_humidity", "", note="from 0 to 1"),),
    "sensor_msgs/NavSatFix": (
        NumberField("latitude", "latitude", "deg"),
        NumberField("longitude", "longitude", "deg"),
        NumberField("altitude", "altitude", "m", note="above the WGS 84 ellipsoid"),
        NumberField("status.status", "status", note="-1: no fix"),
    ),
    "nav_msgs/Odometry": (*_planar("twist.twist."), *_place("pose.pose.")),
    "geometry_msgs/Twist": _planar(""),
    "geometry_msgs/TwistStamped": _planar("twist."),
    "geometry_msgs/TwistWithCovariance": _planar("twist."),
    "geometry_msgs/TwistWithCovarianceStamped": _planar("twist.twist."),
    "geometry_msgs/Pose": _place(""),
    "geometry_msgs/PoseStamped": _place("pose."),
    "geometry_msgs/PoseWithCovarianceStamped": _place("pose.pose."),
    "geometry_msgs/PointStamped": tuple(NumberField(f"point.{a}", a, "m") for a in "xyz"),
    "geometry_msgs/Pose2D": (
        NumberField("x", "x", "m"),
        NumberField("y", "y", "m"),
        NumberField("theta", "yaw", "rad"),
    ),
    "geometry_msgs/Accel": _accelerations(""),
    "geometry_msgs/AccelStamped": _accelerations("accel."),
    "geometry_msgs/Wrench": _force(""),
    "geometry_msgs/WrenchStamped": _force("wrench."),
    "ackermann_msgs/AckermannDrive": _steered(""),
    "ackermann_msgs/AckermannDriveStamped": _steered("drive."),
    "std_msgs/Bool": _FLAG,
    "std_msgs/String": _WORD,
    **{
        f"std_msgs/{kind}": _PLAIN
        for kind in (
            "Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32",
            "UInt64",
        )
    },
}  # fmt: skip
"""Quantities by the short name of a type, which is the same in ROS 1 and ROS 2."""
