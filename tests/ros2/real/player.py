"""Plays messages by a simulated clock on real ROS 2, one at a time, and records the answers.

    python player.py FILE READERS BEFORE AFTER

Each line of FILE has a time in nanoseconds, a topic, and a payload in hexadecimal digits. The
player waits until `/scan` and `/odom` have READERS subscriptions each. It then moves all times and
stamps, so that the first message comes BEFORE seconds before the present time.

A subscription with `SensorDataQoS` keeps five messages and drops the oldest of them where more come
before the node takes one. So the player publishes a message only after the node has answered a
request that followed the message before: the speed is that of the node, and nothing is lost.

When all is played, the clock goes on for AFTER seconds, a heartbeat of the monitor for each step;
after the first second, `played` is printed. Then one line of JSON is printed: what was published,
and what node and interceptor have said.

It runs where rclpy is installed, without fretc.
"""

from __future__ import annotations

import json
import struct
import sys
import time
from pathlib import Path
from typing import Any

import rclpy  # type: ignore[import-not-found]
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from lifecycle_msgs.msg import Transition  # type: ignore[import-not-found]
from lifecycle_msgs.srv import ChangeState, GetState  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from rclpy.duration import Duration  # type: ignore[import-not-found]
from rclpy.executors import SingleThreadedExecutor  # type: ignore[import-not-found]
from rclpy.time import Time  # type: ignore[import-not-found]
from rosgraph_msgs.msg import Clock  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]
from std_msgs.msg import Bool, String  # type: ignore[import-not-found]

SECOND = 10**9
STEP = SECOND // 10
"""Simulated nanoseconds from one time to the next when all is played: a tick."""
KEPT = 1000
"""So many messages are sent again to a subscription that has missed them."""
AGAIN = 1.0
"""Seconds after which the first message of a topic is published again."""
SHORT = 1.0
"""Simulated seconds in which others take what has come to them."""
BEATS = 3
"""The last of so many requests is made after the clock was set: one of them may be under way, and
another one in the queue."""
PATIENCE = 60.0
_STAMP = struct.Struct("<iI")
_STAMPED = ("/scan", "/odom")


class Player:
    """The publishers, and what was heard."""

    def __init__(self, node: Any) -> None:
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(node)
        self.node = node
        types = {"/scan": LaserScan, "/odom": Odometry, "/cmd_vel": Twist}
        self.publishers = {
            topic: node.create_publisher(kind, topic, KEPT) for topic, kind in types.items()
        }
        self.clock = node.create_publisher(Clock, "/clock", 10)
        self.asked = node.create_client(GetState, "/r1_monitor/get_state")
        self.sent: list[tuple[int, str, str]] = []
        self.lines: list[Any] = []
        self.values: dict[str, str] = {}
        """Those of the last diagnostic status of the sources."""
        self.reports = 0
        """How many of these statuses have come."""
        self.wheels: list[float] = []
        self.stops: list[bool] = []
        node.create_subscription(
            Bool, "/gwendolen_control", lambda m: self.stops.append(m.data), KEPT
        )
        node.create_subscription(
            String, "/r1_monitor/verdicts", lambda m: self.lines.append(json.loads(m.data)), KEPT
        )
        node.create_subscription(DiagnosticArray, "/diagnostics", self.note, 10)
        node.create_subscription(
            Twist, "/cmd_vel_filtered", lambda m: self.wheels.append(m.linear.x), KEPT
        )

    def note(self, array: Any) -> None:
        for status in array.status:
            if status.name == "r1_monitor: sources":
                self.values = {each.key: each.value for each in status.values}
                self.reports += 1

    def until(self, holds: Any, seconds: float = PATIENCE) -> bool:
        """Listen until that holds; whether it does."""
        end = time.monotonic() + seconds
        while not holds() and time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)
        return bool(holds())

    def answer(self, client: Any, request: Any) -> None:
        """Wait for the answer of the monitor."""
        future = client.call_async(request)
        assert self.until(future.done), "the monitor is silent"

    def change(self, transition: int) -> None:
        client = self.node.create_client(ChangeState, "/r1_monitor/change_state")
        assert self.until(client.service_is_ready)
        request = ChangeState.Request()
        request.transition.id = transition
        self.answer(client, request)

    def tick(self, now: int) -> None:
        self.clock.publish(Clock(clock=Time(nanoseconds=now).to_msg()))

    def taken(self, topic: str) -> int:
        """How many messages of a topic the monitor has taken, as it reports twice a second."""
        return int(self.values.get(f"messages of {topic}", 0))

    def send(self, now: int, topic: str, data: bytes) -> None:
        """Publish one message, and wait until the monitor has taken it.

        Whatever came to the node before a request is taken before the answer.
        """
        self.tick(now)
        self.publishers[topic].publish(data)
        self.sent.append((now, topic, data.hex()))
        self.answer(self.asked, GetState.Request())

    def play(self, path: Path, readers: int, before: float) -> int:
        """Publish all messages; the time of the last."""
        rows = [line.split() for line in path.read_text().splitlines()]
        assert self.until(
            lambda: all(
                self.publishers[topic].get_subscription_count() >= readers for topic in _STAMPED
            )
        )
        moved = time.time_ns() - round(before * SECOND) - int(rows[0][0])
        begun = set()
        for text, topic, payload in rows:
            now, data = int(text) + moved, bytearray.fromhex(payload)
            if topic in _STAMPED:
                seconds, rest = _STAMP.unpack_from(data, 4)
                stamp = seconds * SECOND + rest + moved
                _STAMP.pack_into(data, 4, *divmod(stamp, SECOND))
            self.send(now, topic, bytes(data))
            while topic in _STAMPED and topic not in begun:
                # A subscription without a memory ignores a publisher that it does not know yet.
                if self.until(lambda topic=topic: self.taken(topic) > 0, AGAIN):
                    begun.add(topic)
                else:
                    self.send(now, topic, bytes(data))
        return now

    def go_on(self, now: int, after: float) -> list[int]:
        """Let time pass without messages; the times."""
        times = [now + i * STEP for i in range(1, round(after * SECOND) // STEP + 1)]
        for each in times:
            self.tick(each)
            self.answer(self.asked, GetState.Request())
            beats = len(self.stops)
            assert self.until(lambda beats=beats: len(self.stops) >= beats + BEATS)
        return times


def main(path: str, readers: str, before: str, after: str) -> None:
    """Play, and print the answers."""
    rclpy.init()
    player = Player(rclpy.create_node("player"))
    player.change(Transition.TRANSITION_CONFIGURE)
    player.change(Transition.TRANSITION_ACTIVATE)
    end = player.play(Path(path), int(readers), float(before))
    for publisher in player.publishers.values():
        assert publisher.wait_for_all_acked(Duration(seconds=PATIENCE))
    times = player.go_on(end, SHORT)
    print("played", flush=True)
    times += player.go_on(times[-1], float(after) - SHORT)
    reports = player.reports
    assert player.until(lambda: player.reports > reports)
    found = {
        "sent": player.sent,
        "times": times,
        "lines": player.lines,
        "values": player.values,
        "wheels": player.wheels,
    }
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
