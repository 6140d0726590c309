"""Plays messages by a simulated clock on real ROS 2, and hears what the monitor says.

    python player.py FILE RATE READERS

FILE has on each line a time in nanoseconds, a topic, and a payload in hexadecimal digits. They are
published as soon as `/scan` and `/odom` have so many readers, RATE times as fast as their times;
more slowly where the monitor has not kept up. Then each line of standard input is answered by all
that was heard; after `on` the clock goes on by a second.

It runs where rclpy is installed, without fretc.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from pathlib import Path
from typing import Any

import rclpy  # type: ignore[import-not-found]
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from lifecycle_msgs.msg import Transition  # type: ignore[import-not-found]
from lifecycle_msgs.srv import ChangeState  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from rclpy.qos import qos_profile_sensor_data  # type: ignore[import-not-found]
from rclpy.time import Time  # type: ignore[import-not-found]
from rosgraph_msgs.msg import Clock  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]
from std_msgs.msg import Bool, String  # type: ignore[import-not-found]

AHEAD = 3
"""The most messages of a topic that the monitor has not taken yet: less than its queues hold."""
AFTERWARDS = 10**8
"""Simulated nanoseconds from one time to the next when all is played."""


class Player:
    """The publishers, and what was heard."""

    def __init__(self, node: Any) -> None:
        self.node = node
        self.publishers = {
            "/scan": node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data),
            "/odom": node.create_publisher(Odometry, "/odom", 1000),
            "/cmd_vel": node.create_publisher(Twist, "/cmd_vel", 10),
        }
        self.clock = node.create_publisher(Clock, "/clock", 10)
        self.lines: list[Any] = []
        self.values: dict[str, str] = {}
        """Those of the last diagnostic status of the sources."""
        self.wheels: list[float] = []
        self.sent = dict.fromkeys(self.publishers, 0)
        self.taken = [dict(self.sent), dict(self.sent)]
        """What was sent at the last two requests of the monitor."""
        self.requested = threading.Event()
        node.create_subscription(Bool, "/gwendolen_control", self.take, 10)
        node.create_subscription(
            String, "/r1_monitor/verdicts", lambda m: self.lines.append(json.loads(m.data)), 100
        )
        node.create_subscription(DiagnosticArray, "/diagnostics", self.note, 10)
        node.create_subscription(
            Twist, "/cmd_vel_filtered", lambda m: self.wheels.append(m.linear.x), 10
        )

    def take(self, _: Any) -> None:
        """The monitor is at work: it has taken what was sent at its request before."""
        self.taken = [self.taken[-1], dict(self.sent)]
        self.requested.set()

    def keep_up(self, topic: str) -> None:
        """Wait for the monitor."""
        while self.sent[topic] - self.taken[0][topic] >= AHEAD:
            self.requested.clear()
            assert self.requested.wait(60), "the monitor is silent"
        self.sent[topic] += 1

    def has_taken(self, topic: str) -> bool:
        """Whether the monitor has told that a message of the topic has come."""
        return int(self.values.get(f"messages of {topic}", 0)) > 0

    def note(self, array: Any) -> None:
        for status in array.status:
            if status.name == "r1_monitor: sources":
                self.values = {each.key: each.value for each in status.values}

    def change(self, transition: int) -> None:
        """Ask the monitor for a transition until it has made one."""
        client = self.node.create_client(ChangeState, "/r1_monitor/change_state")
        assert client.wait_for_service(60)
        request = ChangeState.Request()
        request.transition.id = transition
        answered = threading.Event()
        client.call_async(request).add_done_callback(lambda _: answered.set())
        answered.wait(15)

    def tick(self, now: int) -> None:
        self.clock.publish(Clock(clock=Time(nanoseconds=now).to_msg()))

    def play(self, path: Path, rate: float, readers: int) -> int:
        """Publish all messages; the time of the last."""
        rows = [line.split() for line in path.read_text().splitlines()]
        self.tick(int(rows[0][0]) - 10**9)
        while any(
            self.publishers[t].get_subscription_count() < readers for t in ("/scan", "/odom")
        ):
            time.sleep(0.02)
        begin, first = time.monotonic(), int(rows[0][0])
        for text, topic, payload in rows:
            now = int(text)
            time.sleep(max(0.0, begin + (now - first) / 1e9 / rate - time.monotonic()))
            self.keep_up(topic)
            if topic == "/odom":  # the one that comes most often
                self.tick(now)
            self.publishers[topic].publish(bytes.fromhex(payload))
            while topic == "/odom" and not self.has_taken(topic):
                # A reliable reader that has just met its publisher keeps messages back for seconds,
                # and then all but the last ones of its queue are lost.
                time.sleep(0.02)
                begin = time.monotonic() - (now - first) / 1e9 / rate
        return now


def main(path: str, rate: str, readers: str) -> None:
    """Play, then let time go on for ever."""
    rclpy.init()
    node = rclpy.create_node("player")
    player = Player(node)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    player.change(Transition.TRANSITION_CONFIGURE)
    player.change(Transition.TRANSITION_ACTIVATE)
    now = player.play(Path(path), float(rate), int(readers))
    for line in sys.stdin:
        for _ in range(10 if line == "on\n" else 0):
            now += AFTERWARDS
            player.tick(now)
            time.sleep(0.01)
        found = {"lines": player.lines, "values": player.values, "wheels": player.wheels}
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
