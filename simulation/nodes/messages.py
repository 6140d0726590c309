"""The robot's messages as values: what each part says and hears, and the log keeps."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from simulation.world.lidar import Lidar
from simulation.world.motion import BodyVelocity, Pose
from simulation.world.scene import ROBOT

if TYPE_CHECKING:
    from rosbags.typesys.store import Msg, Msgarg

TYPES = get_typestore(Stores.ROS2_JAZZY)

MAP, ODOM, BASE, LIDAR = "map", "odom", "base_link", "velodyne"
"""Frames, each at the child end of the one before."""


def laser_scan(time: int, ranges: NDArray[np.float32], lidar: Lidar) -> "Msg":
    """A full turn measured at `time`; all beams at once, as the simulator measures them."""
    return _new(
        "sensor_msgs/msg/LaserScan",
        header=_header(time, LIDAR),
        angle_min=float(lidar.angles[0]),
        angle_max=float(lidar.angles[-1]),
        angle_increment=lidar.increment,
        time_increment=0.0,
        scan_time=lidar.period,
        range_min=lidar.range_min,
        range_max=lidar.range_max,
        ranges=ranges,
        intensities=np.zeros(0, np.float32),
    )


def odometry(time: int, frame: str, pose: Pose, velocity: BodyVelocity) -> "Msg":
    """A pose in `frame` and a velocity in the body's frame; covariances are left at 0, unknown."""
    return _new(
        "nav_msgs/msg/Odometry",
        header=_header(time, frame),
        child_frame_id=BASE,
        pose=_new("geometry_msgs/msg/PoseWithCovariance", pose=_pose(pose), covariance=_unknown()),
        twist=_new(
            "geometry_msgs/msg/TwistWithCovariance", twist=twist(velocity), covariance=_unknown()
        ),
    )


def twist(velocity: BodyVelocity) -> "Msg":
    """`linear.x` and `angular.z`."""
    return _new(
        "geometry_msgs/msg/Twist",
        linear=_vector(velocity.forward, 0.0),
        angular=_new("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=velocity.turn),
    )


def velocity(message: Any) -> BodyVelocity:
    """What a Twist says."""
    return BodyVelocity(message.linear.x, message.angular.z)


def motion(message: Any) -> tuple[Pose, BodyVelocity]:
    """What an Odometry says."""
    pose = message.pose.pose
    yaw = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
    planar = Pose(pose.position.x, pose.position.y, math.remainder(yaw, 2 * math.pi))
    return planar, velocity(message.twist.twist)


def boolean(value: bool) -> "Msg":
    """A bare truth value."""
    return _new("std_msgs/msg/Bool", data=value)


def goal_pose(time: int, pose: Pose) -> "Msg":
    """A goal in the room's frame."""
    return _new("geometry_msgs/msg/PoseStamped", header=_header(time, MAP), pose=_pose(pose))


def number(value: float) -> "Msg":
    """A bare number."""
    return _new("std_msgs/msg/Float64", data=value)


def text(value: str) -> "Msg":
    """A bare text."""
    return _new("std_msgs/msg/String", data=value)


def battery(time: int, charge: float) -> "Msg":
    """How full the battery is, from 0 to 1; voltages and all the rest are not measured."""
    return _new(
        "sensor_msgs/msg/BatteryState",
        header=_header(time, BASE),
        voltage=math.nan,
        temperature=math.nan,
        current=math.nan,
        charge=math.nan,
        capacity=math.nan,
        design_capacity=math.nan,
        percentage=charge,
        power_supply_status=0,
        power_supply_health=0,
        power_supply_technology=0,
        present=True,
        cell_voltage=np.zeros(0, np.float32),
        cell_temperature=np.zeros(0, np.float32),
        location="",
        serial_number="",
    )


def clock(time: int) -> "Msg":
    """Simulated time."""
    return _new("rosgraph_msgs/msg/Clock", clock=_stamp(time))


def transforms(time: int, estimate: Pose) -> "Msg":
    """From the odometry's frame to the robot."""
    return _transforms(time, ((ODOM, BASE, estimate),))


def fixed_transforms(time: int) -> "Msg":
    """The ends of the chain: map and odometry's frame coincide, robot and lidar too."""
    origin = Pose(0.0, 0.0)
    return _transforms(time, ((MAP, ODOM, origin), (BASE, LIDAR, origin)))


def occupancy(time: int, clearance: NDArray[np.float64], resolution: float) -> "Msg":
    """The map; `clearance` in metres, by cells (x, y), 0 where something stands."""
    cells = np.where(clearance > 0, 0, 100).astype(np.int8)
    width, height = cells.shape
    info = _new(
        "nav_msgs/msg/MapMetaData",
        map_load_time=_stamp(time),
        resolution=resolution,
        width=width,
        height=height,
        origin=_pose(Pose(0.0, 0.0)),
    )
    data = np.ascontiguousarray(cells.T).reshape(-1)
    return _new("nav_msgs/msg/OccupancyGrid", header=_header(time, MAP), info=info, data=data)


def description() -> "Msg":
    """The robot as URDF: its outline."""
    box = f'<box size="{ROBOT.length} {ROBOT.width} 0.24"/>'
    shape = f'<origin xyz="0 0 0.17"/><geometry>{box}</geometry>'
    text = (
        f'<robot name="scout_mini"><link name="{BASE}"><visual>{shape}</visual>'
        f'<collision>{shape}</collision></link><link name="{LIDAR}"/>'
        f'<joint name="lidar" type="fixed"><parent link="{BASE}"/><child link="{LIDAR}"/></joint>'
        "</robot>"
    )
    return _new("std_msgs/msg/String", data=text)


def _transforms(time: int, links: tuple[tuple[str, str, Pose], ...]) -> "Msg":
    return _new(
        "tf2_msgs/msg/TFMessage",
        transforms=[
            _new(
                "geometry_msgs/msg/TransformStamped",
                header=_header(time, parent),
                child_frame_id=child,
                transform=_new(
                    "geometry_msgs/msg/Transform",
                    translation=_vector(pose.x, pose.y),
                    rotation=_quaternion(pose.yaw),
                ),
            )
            for parent, child, pose in links
        ],
    )


def _new(type_name: str, **fields: "Msgarg") -> "Msg":
    return TYPES.types[type_name](**fields)


def _header(time: int, frame: str) -> "Msg":
    return _new("std_msgs/msg/Header", stamp=_stamp(time), frame_id=frame)


def _stamp(time: int) -> "Msg":
    seconds, nanoseconds = divmod(time, 10**9)
    return _new("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)


def _pose(pose: Pose) -> "Msg":
    position = _new("geometry_msgs/msg/Point", x=pose.x, y=pose.y, z=0.0)
    return _new("geometry_msgs/msg/Pose", position=position, orientation=_quaternion(pose.yaw))


def _vector(x: float, y: float) -> "Msg":
    return _new("geometry_msgs/msg/Vector3", x=x, y=y, z=0.0)


def _quaternion(yaw: float) -> "Msg":
    z, w = math.sin(yaw / 2), math.cos(yaw / 2)
    return _new("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=z, w=w)


def _unknown() -> NDArray[np.float64]:
    return np.zeros(36)
