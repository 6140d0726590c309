"""Runs in ROS 2, without fretc: a lidar that measures the answers, or a node written by hand.

python3 live_robot_ros2.py lidar SCANS NODE
python3 live_robot_ros2.py by-hand least|outline REQUIREMENTS
python3 live_robot_ros2.py listener

The node by hand hears the same topics as the emitted node, and publishes the same messages: each
change of the stop, the stop at each heartbeat, a line for each requirement that a tick triggers,
and the diagnostics twice a second.
"""

import json
import math
import sys
import threading
import time
from typing import Any

import rclpy  # type: ignore[import-not-found]
from diagnostic_msgs.msg import DiagnosticArray, KeyValue
from diagnostic_msgs.msg import DiagnosticStatus as Status
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from lifecycle_msgs.msg import Transition  # type: ignore[import-not-found]
from lifecycle_msgs.srv import ChangeState  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from rclpy.executors import SingleThreadedExecutor  # type: ignore[import-not-found]
from rclpy.qos import qos_profile_sensor_data  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]
from std_msgs.msg import Bool, String  # type: ignore[import-not-found]

BEAMS, PERIOD = 720, 0.025
WARM = 80
"""Scans before the first that counts."""
TICK, HELD, REPORT = 0.1, 0.2, 0.5
"""Seconds."""


def activate(node: Any, name: str) -> None:
    """Configure and activate a managed node."""
    client = node.create_client(ChangeState, f"/{name}/change_state")
    assert client.wait_for_service(60.0)
    for transition in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
        request = ChangeState.Request()
        request.transition.id = transition
        answered = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _, answered=answered: answered.set())
        assert answered.wait(60.0)
        assert future.result().success
    node.destroy_client(client)


def lidar(scans: int, name: str) -> None:
    """Scans, near and far in turn; prints the times to the stop and to zero on the wheels."""
    node = rclpy.create_node("lidar")
    publisher = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
    odometry = node.create_publisher(Odometry, "/odom", 10)
    commands = node.create_publisher(Twist, "/cmd_vel", 1)
    seen: dict[str, float] = {}

    def note(kind: str, stop: bool) -> None:
        if stop:
            seen.setdefault(kind, time.perf_counter())

    node.create_subscription(Bool, "/stop", lambda m: note("stop", m.data), 10)
    node.create_subscription(Bool, "/by_hand", lambda m: note("by hand", m.data), 10)
    node.create_subscription(Twist, "/wheels", lambda m: note("zero", m.linear.x == 0), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    activate(node, name)
    while (
        min(p.get_subscription_count() for p in (publisher, odometry)) < 2
        or commands.get_subscription_count() < 1
        or min(map(node.count_publishers, ("/stop", "/by_hand", "/wheels"))) < 1
        or min(map(node.count_subscribers, ("/stop", "/by_hand"))) < 2
    ):
        time.sleep(0.01)
    step = 2 * math.pi / BEAMS
    scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_min=0.02, range_max=30.0)
    ranges = {
        near: [0.5 if near and i == 300 else 2.0 + i / BEAMS for i in range(BEAMS)]
        for near in (True, False)
    }
    times: dict[str, list[float]] = {"stop": [], "zero": [], "by hand": []}
    drive, moves = Twist(), Odometry()
    drive.linear.x = moves.twist.twist.linear.x = 0.5
    due, asked = time.monotonic() + 1.0, 0.0
    for k in range(-WARM, scans):
        time.sleep(max(0.0, due - time.monotonic()))
        due += PERIOD
        scan.header.stamp = node.get_clock().now().to_msg()
        scan.ranges = ranges[k % 2 == 1]
        if k == 0:
            print("begun", flush=True)
        if k % 2 == 0:
            publisher.publish(scan)
            time.sleep(0.012)
            moves.header.stamp = node.get_clock().now().to_msg()
            odometry.publish(moves)
            commands.publish(drive)  # the robot may move, and does
            continue
        for kind, at in [*seen.items()]:
            if k > 2:
                times[kind].append(1000 * (at - asked))
        seen.clear()
        asked = time.perf_counter()
        publisher.publish(scan)
    print(json.dumps(times), flush=True)
    executor.shutdown()
    thread.join()


def least(scan: Any) -> float:
    """The least valid range."""
    low, high = scan.range_min, scan.range_max
    return min([r for r in scan.ranges if low <= r <= high], default=0.0)


def outline(scan: Any) -> float:
    """The distance from a square of 0.6 m."""
    nearest = math.inf
    for i, r in enumerate(scan.ranges):
        if scan.range_min <= r <= scan.range_max and r - 0.43 < nearest:
            angle = scan.angle_min + i * scan.angle_increment
            dx = max(0.0, abs(r * math.cos(angle)) - 0.3)
            dy = max(0.0, abs(r * math.sin(angle)) - 0.3)
            nearest = min(nearest, math.hypot(dx, dy))
    return nearest


class ByHand:
    """What somebody writes who has the requirements in mind: a near scan stops what moves."""

    def __init__(self, kind: str, count: int) -> None:
        self.node = rclpy.create_node("by_hand")
        self.distance, self.limit = (outline, 0.4) if kind == "outline" else (least, 1.0)
        self.count = count
        self.stop, self.near, self.ever = True, False, False
        self.since: float | None = None
        self.heard = dict.fromkeys(("/scan", "/odom"), 0.0)
        self.counts = dict.fromkeys(self.heard, 0)
        self.reported, self.triggered = 0.0, 0
        self.stops = self.node.create_publisher(Bool, "/by_hand", 10)
        self.lines = self.node.create_publisher(String, "/by_hand/verdicts", 100)
        self.reports = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.node.create_subscription(LaserScan, "/scan", self.on_scan, qos_profile_sensor_data)
        self.node.create_subscription(Odometry, "/odom", self.on_odometry, qos_profile_sensor_data)
        self.node.create_timer(TICK, self.on_tick)

    def on_scan(self, scan: Any) -> None:
        self.note("/scan")
        self.near = self.distance(scan) < self.limit
        self.ever = self.ever or self.near
        self.decide()

    def on_odometry(self, message: Any) -> None:
        self.note("/odom")
        if abs(message.twist.twist.linear.x) >= 0.01:
            self.since = None
        elif self.since is None:
            self.since = time.monotonic()
        self.decide()

    def note(self, topic: str) -> None:
        self.heard[topic] = time.monotonic()
        self.counts[topic] += 1

    def decide(self) -> None:
        """Publish the stop where it changes."""
        now = time.monotonic()
        stands = self.since is not None and now - self.since >= HELD
        silent = now - min(self.heard.values()) > 0.3
        stop = silent or (self.near and not stands)
        if stop != self.stop:
            self.stops.publish(Bool(data=stop))
        self.stop = stop

    def on_tick(self) -> None:
        """The heartbeat, the lines of what the tick has triggered, and the diagnostics."""
        self.decide()
        self.stops.publish(Bool(data=self.stop))
        now = self.node.get_clock().now()
        if self.ever:
            self.triggered = now.nanoseconds
            for i in range(self.count):
                line = {
                    "type": "requirement",
                    "requirement": f"R{i}",
                    "verdict": "violated" if self.stop else "satisfied",
                    "obligation_pending": self.stop,
                    "triggered_ns": self.triggered,
                    "open_ns": None,
                    "deadline_ns": None,
                    "violated_ns": None,
                    "time_ns": now.nanoseconds,
                }
                self.lines.publish(String(data=json.dumps(line)))
        self.ever = False
        if time.monotonic() - self.reported >= REPORT:
            self.reported = time.monotonic()
            self.reports.publish(self.report(now))

    def report(self, now: Any) -> Any:
        values = [KeyValue(key=f"messages of {t}", value=str(n)) for t, n in self.counts.items()]
        message = DiagnosticArray()
        message.header.stamp = now.to_msg()
        message.status = [Status(level=b"\0", name="by_hand: sources", message="ok", values=values)]
        for i in range(self.count):
            own = [
                KeyValue(key="verdict", value="violated" if self.stop else "satisfied"),
                KeyValue(key="triggered_ns", value=str(self.triggered)),
                KeyValue(key="obligation_pending", value=str(self.stop)),
            ]
            message.status.append(
                Status(level=b"\0", name=f"by_hand: R{i}", message="ok", values=own)
            )
        return message


def main() -> None:
    rclpy.init()
    if sys.argv[1] == "lidar":
        lidar(int(sys.argv[2]), sys.argv[3])
    elif sys.argv[1] == "listener":  # the interceptor's part for the node by hand
        node = rclpy.create_node("listener")
        node.create_subscription(Bool, "/by_hand", lambda _: None, 10)
        rclpy.spin(node)
    else:
        rclpy.spin(ByHand(sys.argv[2], int(sys.argv[3])).node)


if __name__ == "__main__":
    main()
