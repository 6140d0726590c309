"""Runs in ROS 1, under Debian's Python: a lidar that measures the answers, or a node by hand.

python3 live_robot.py lidar SCANS
python3 live_robot.py by-hand least|outline
"""

import json
import math
import sys
import time

import rospy
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]
from std_msgs.msg import Bool  # type: ignore[import-not-found]

BEAMS, PERIOD = 720, 0.025
CORNERS = ((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3))


def lidar(scans: int) -> None:
    """Scans, near and far in turn; prints the times to the stop and to zero on the wheels."""
    rospy.init_node("lidar", disable_signals=True)
    publisher = rospy.Publisher("/scan", LaserScan, queue_size=1)
    odometry = rospy.Publisher("/odom", Odometry, queue_size=1)
    commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
    seen: dict[str, float] = {}

    def note(kind: str, stop: bool) -> None:
        if stop:
            seen.setdefault(kind, time.perf_counter())

    rospy.Subscriber("/stop", Bool, lambda m: note("stop", m.data), queue_size=10)
    rospy.Subscriber("/by_hand", Bool, lambda m: note("by hand", m.data), queue_size=10)
    rospy.Subscriber("/wheels", Twist, lambda m: note("zero", m.linear.x == 0), queue_size=10)
    step = 2 * math.pi / BEAMS
    scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_min=0.02, range_max=30.0)
    ranges = {near: [0.5 if near and i == 300 else 2.0 + i / BEAMS for i in range(BEAMS)]
              for near in (True, False)}  # fmt: skip
    while publisher.get_num_connections() < 2 or commands.get_num_connections() < 1:
        time.sleep(0.01)
    found: dict[str, list[float]] = {"stop": [], "zero": [], "by hand": []}
    drive, moves = Twist(), Odometry()
    drive.linear.x = moves.twist.twist.linear.x = 0.5
    due, asked = time.monotonic() + 1.0, 0.0
    for k in range(-WARM, scans):
        time.sleep(max(0.0, due - time.monotonic()))
        due += PERIOD
        scan.header.stamp = rospy.get_rostime()
        scan.ranges = ranges[k % 2 == 1]
        if k == 0:
            print("begun", flush=True)
        if k % 2 == 0:
            publisher.publish(scan)
            time.sleep(0.012)
            moves.header.stamp = rospy.get_rostime()
            odometry.publish(moves)
            commands.publish(drive)  # the robot may move, and does
            continue
        for kind, at in [*seen.items()]:
            if k > 2:
                found[kind].append(1000 * (at - asked))
        seen.clear()
        asked = time.perf_counter()
        publisher.publish(scan)
    print(json.dumps(found), flush=True)


WARM = 80
"""Scans before the first that counts."""


def by_hand(kind: str) -> None:
    """What somebody writes who needs no requirement: near stops, far does not."""
    rospy.init_node("by_hand")
    publisher = rospy.Publisher("/by_hand", Bool, queue_size=10)
    state = {"stop": True}

    def outline(scan: LaserScan) -> float:
        least = math.inf
        for i, r in enumerate(scan.ranges):
            if scan.range_min <= r <= scan.range_max and r - 0.43 < least:
                angle = scan.angle_min + i * scan.angle_increment
                dx = max(0.0, abs(r * math.cos(angle)) - 0.3)
                dy = max(0.0, abs(r * math.sin(angle)) - 0.3)
                least = min(least, math.hypot(dx, dy))
        return least

    def hear(scan: LaserScan) -> None:
        if kind == "outline":
            stop = outline(scan) < 0.4
        else:
            low, high = scan.range_min, scan.range_max
            stop = min([r for r in scan.ranges if low <= r <= high], default=0.0) < 1.0
        if stop != state["stop"]:
            publisher.publish(stop)
        state["stop"] = stop

    rospy.Subscriber("/scan", LaserScan, hear, queue_size=1)
    rospy.Subscriber("/odom", Odometry, lambda _: None, queue_size=1)
    rospy.Timer(rospy.Duration(0.1), lambda _: publisher.publish(state["stop"]))
    rospy.spin()


if __name__ == "__main__":
    if sys.argv[1] == "lidar":
        lidar(int(sys.argv[2]))
    elif sys.argv[1] == "by-hand":
        by_hand(sys.argv[2])
    else:
        rospy.init_node("listener")
        rospy.Subscriber("/by_hand", Bool, lambda _: None)
        rospy.spin()
