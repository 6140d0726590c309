"""A robot on real ROS 2, which drives towards a wall; what the wheels hear moves it.

It runs where rclpy is installed, without fretc. Each line of standard input is answered by
`Robot.state`, in JSON. `go` begins; `away` puts it far from the wall; `stuck` and `free`: its
brakes; `plans` and `rests`: its planner, which is `lossy` as best effort, else `reliable`; `hear`
forgets what was heard so far. `simulate RATE` lets it publish a clock that is as many times as fast
as real time, `back` sets this clock back by 100 s, and `log` adds what was published since.
`second` publishes on the topic of stops, too, until it is `alone`; `crowd` publishes 200 more
topics. `change NODE TRANSITION` asks for a transition of a managed node, as `ros2 lifecycle set`
does; `try NODE TRANSITION` does not wait for the answer.
"""

from __future__ import annotations

import json
import math
import sys
import threading
from typing import Any

import rclpy  # type: ignore[import-not-found]
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from lifecycle_msgs.msg import Transition  # type: ignore[import-not-found]
from lifecycle_msgs.srv import ChangeState  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from rclpy.clock import Clock, ClockType  # type: ignore[import-not-found]
from rclpy.executors import SingleThreadedExecutor  # type: ignore[import-not-found]
from rclpy.qos import qos_profile_sensor_data  # type: ignore[import-not-found]
from rclpy.serialization import serialize_message  # type: ignore[import-not-found]
from rclpy.time import Time  # type: ignore[import-not-found]
from rosgraph_msgs.msg import Clock as ClockMessage  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]
from std_msgs.msg import Bool, String  # type: ignore[import-not-found]

BEAMS, PERIOD, FAR, WALL, SPEED = 180, 0.05, 0.4, 0.01, 0.3
PATIENCE = 60.0
"""Seconds for an answer that takes a fraction of one, on a machine that may be busy."""
FRONT = 0.306
"""From the lidar to the bumper, m."""


class Robot:
    """Its clearance, m, and its speed, m/s; and what nodes say of it."""

    def __init__(self, node: Any) -> None:
        self.node = node
        self.clearance, self.speed, self.wanted, self.stuck, self.plans = FAR, 0.0, 0.0, False, True
        self.count, self.going = 0, False
        self.wheels: list[float] = []
        self.stops: list[bool] = []
        self.lines: list[Any] = []
        self.scans = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        self.odometry = node.create_publisher(Odometry, "/odom", 10)
        self.commands = node.create_publisher(Twist, "/cmd_vel", 10)
        self.second: Any = None
        self.crowd: list[Any] = []
        node.create_subscription(Twist, "/cmd_vel_filtered", self.drive, 10)
        node.create_subscription(
            Bool, "/gwendolen_control", lambda said: self.stops.append(said.data), 10
        )
        node.create_subscription(
            String, "/r1_monitor/verdicts", lambda m: self.lines.append(json.loads(m.data)), 100
        )
        self.steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.timer = node.create_timer(PERIOD, self.step, clock=self.steady)
        self.clock: Any = None
        """The publisher of simulated time."""
        self.now = 10**12
        """Simulated time in nanoseconds."""
        self.log: list[tuple[str, str, int, str]] = []
        """In simulated time: topic, type, time, and the payload in hexadecimal digits."""
        step = 2 * math.pi / BEAMS
        self.cosines = [math.cos(-math.pi + i * step) for i in range(BEAMS)]
        self.scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_min=0.02)
        self.scan.range_max = 30.0

    def drive(self, said: Any) -> None:
        self.wanted = said.linear.x
        self.wheels.append(self.wanted)

    def ranges(self) -> list[float]:
        """A wall ahead, and nothing behind."""
        ahead = self.clearance + FRONT
        return [ahead / c if c > 0.04 else math.inf for c in self.cosines]

    def step(self) -> None:
        """A planner that always wants to drive on, and the robot."""
        if not self.going:
            return
        if not self.stuck:
            self.speed = self.wanted
        self.clearance = max(WALL, self.clearance - self.speed * PERIOD)
        stamp = self.time()
        self.scan.header.stamp = stamp
        self.scan.ranges = self.ranges()
        self.publish(self.scans, self.scan)
        odometry = Odometry()
        odometry.header.stamp = stamp
        odometry.twist.twist.linear.x = self.speed
        self.publish(self.odometry, odometry)
        if self.plans:
            command = Twist()
            command.linear.x = SPEED
            self.commands.publish(command)
        if self.second:
            self.second.publish(Bool(data=False))
        self.count += 1

    def time(self) -> Any:
        """The present time; one step later by a simulated clock."""
        if self.clock is None:
            return self.node.get_clock().now().to_msg()
        self.now += round(PERIOD * 1e9)
        stamp = Time(nanoseconds=self.now).to_msg()
        self.clock.publish(ClockMessage(clock=stamp))
        return stamp

    def publish(self, publisher: Any, message: Any) -> None:
        publisher.publish(message)
        if self.clock is not None:
            kind = type(message)
            package = kind.__module__.partition(".")[0]
            payload = serialize_message(message).hex()
            self.log.append(
                (publisher.topic_name, f"{package}/msg/{kind.__name__}", self.now, payload)
            )

    def simulate(self, rate: float) -> None:
        """Publish a clock that many times as fast as real time."""
        self.clock = self.node.create_publisher(ClockMessage, "/clock", 10)
        self.node.destroy_timer(self.timer)
        self.timer = self.node.create_timer(PERIOD / rate, self.step, clock=self.steady)

    def state(self) -> dict[str, Any]:
        """All that a test asks for."""
        return {
            "clearance": self.clearance,
            "speed": self.speed,
            "scans": self.count,
            "wheels": self.wheels,
            "stops": self.stops,
            "lines": self.lines,
            "readers": [p.get_subscription_count() for p in (self.scans, self.odometry)],
            "gates": [
                self.commands.get_subscription_count(),
                self.node.count_publishers("/cmd_vel_filtered"),
            ],
            "monitors": self.node.count_publishers("/gwendolen_control"),
            "managed": self.node.count_services("/r1_monitor/change_state"),
        }

    def change(self, name: str, transition: str, *, waits: bool = True) -> bool:
        """Ask a managed node for it; whether it has done it."""
        client = self.node.create_client(ChangeState, f"/{name}/change_state")
        assert client.wait_for_service(PATIENCE), name
        request = ChangeState.Request()
        request.transition.id = getattr(Transition, f"TRANSITION_{transition.upper()}")
        for attempt in range(4):
            answered = threading.Event()
            future = client.call_async(request)
            future.add_done_callback(lambda _, answered=answered: answered.set())
            if not waits:
                return False
            if answered.wait(PATIENCE / 4):
                self.node.destroy_client(client)
                # A node that has not met the client yet does what is asked, and its answer is lost.
                return attempt > 0 or future.result().success
        raise AssertionError(f"no answer: {transition}")

    def obey(self, word: str, *more: str) -> bool:
        """Do what is asked; False: it was refused."""
        if word == "go":
            self.going = True
        elif word == "away":
            self.clearance = FAR
        elif word in ("stuck", "free"):
            self.stuck = word == "stuck"
        elif word in ("plans", "rests"):
            self.plans = word == "plans"
        elif word in ("lossy", "reliable"):
            self.node.destroy_publisher(self.commands)
            qos = qos_profile_sensor_data if word == "lossy" else 10
            self.commands = self.node.create_publisher(Twist, "/cmd_vel", qos)
        elif word == "hear":
            self.wheels, self.stops = [], []
        elif word == "simulate":
            self.simulate(float(*more))
        elif word == "back":
            self.now -= 100 * 10**9
        elif word == "second":
            self.second = self.node.create_publisher(Bool, "/gwendolen_control", 10)
        elif word == "crowd":
            for i in range(200):
                self.crowd.append(self.node.create_publisher(String, f"/crowd_{i}", 10))
        elif word == "alone":
            second, self.second = self.second, None
            self.node.destroy_publisher(second)
        elif word in ("change", "try"):
            return self.change(*more, waits=word == "change")
        return True


def main() -> None:
    """Do what is asked, for ever."""
    rclpy.init()
    node = rclpy.create_node("robot")
    robot = Robot(node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    for line in sys.stdin:
        done = robot.obey(*line.split())
        log = robot.log if line == "log\n" else []
        print(json.dumps({"done": done, "log": log, **robot.state()}), flush=True)


if __name__ == "__main__":
    main()
