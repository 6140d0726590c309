"""On real ROS 2: publishers and readers that do not fit the node, or `fretc watch dds`.

Each is told by the name of its topic. What could be misread is not read: the robot stands.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fretc.watch.sources.dds import Dds
from fretish.diagnostics.diagnostic import Code
from tests.effort import full_only
from tests.programs import needs_package
from tests.ros1 import until
from tests.ros2.emitted import write
from tests.ros2.real.network import PATIENCE, Network, network
from tests.source_listener import SourceListener, closed

ROOT = Path(__file__).parents[4]
ODOMETRY = "nav_msgs/msg/Odometry"
OTHER_HASH = "RIHS01_" + "0" * 64

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


@pytest.fixture(params=["jazzy", pytest.param("kilted", marks=full_only("a second release"))])
def here(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Network]:
    with network(tmp_path, request.param) as place:
        for name, value in place.of_fretc.items():
            monkeypatch.setenv(name, value)
        yield place


READER = """
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("late")
kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
subscription = node.create_subscription(String, "/r1_monitor/verdicts", print, kept)
rclpy.spin(node)
"""
OTHERS = f"""
import time
from fretc.watch.sources.dds_domain import join
from fretc.watch.sources.dds_types import Offer
writer = join().writer("/odom", Offer({ODOMETRY!r}, {OTHER_HASH!r}, reliable=True), None)
time.sleep(600)
"""


def test_what_does_not_fit_the_node_is_told_and_what_would_be_misread_stops_the_robot(
    here: Network, tmp_path: Path
) -> None:
    made = write(ROOT / "requirements/r1.fret", tmp_path / "made")
    robot, node = here.robot(), here.monitor(made)
    here.interceptor(made)
    robot.ask("go")
    assert robot.change("configure", "activate") == [True, True]
    here.start("-c", READER, stderr=subprocess.DEVNULL)
    kept = "topic '/r1_monitor/verdicts', requesting incompatible QoS."
    until("the node tells of the reader", lambda: kept in node.said, PATIENCE)

    robot.goes_on()
    environment = {**here.of_fretc, "PYTHONPATH": str(ROOT)}
    others = subprocess.Popen([sys.executable, "-c", OTHERS], env=environment)
    try:
        what = f"publishes another definition of {ODOMETRY}, {OTHER_HASH}: nothing is known of it"
        until("it is told", lambda: what in node.said, PATIENCE)
        assert "/odom: " in node.said
        robot.ask("away")
        state = robot.until("it stands, far from the wall", lambda s: s["speed"] == 0)
        assert state["clearance"] > 0.1
        assert state["stops"][-1] is True
    finally:
        others.send_signal(signal.SIGTERM)  # it says nothing: its lease ends
        others.wait()
    robot.goes_on()
    assert node.end(signal.SIGINT) == 0


PUBLISHERS = """
import sys
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("offers")
publishers = {}
for reliability in ("RELIABLE", "BEST_EFFORT"):
    for durability in ("TRANSIENT_LOCAL", "VOLATILE"):
        qos = QoSProfile(
            depth=1000,  # so that the first stays
            reliability=ReliabilityPolicy[reliability],
            durability=DurabilityPolicy[durability],
        )
        publishers[f"{reliability} {durability}"] = node.create_publisher(String, "/x", qos)
for name, publisher in publishers.items():
    publisher.publish(String(data=f"early {name}"))
node.create_timer(
    0.1, lambda: [p.publish(String(data=name)) for name, p in publishers.items()]
)
rclpy.spin(node)
"""


def test_a_watch_reads_whatever_quality_of_service_a_publisher_offers(here: Network) -> None:
    here.start("-c", PUBLISHERS)
    with closed(SourceListener(Dds(), "/x")) as listener:
        names = {
            f"{reliability} {durability}".encode()
            for reliability in ("RELIABLE", "BEST_EFFORT")
            for durability in ("TRANSIENT_LOCAL", "VOLATILE")
        }
        early = b"early RELIABLE TRANSIENT_LOCAL"
        texts: set[bytes] = set()

        def all_have_come() -> bool:
            texts.update(each[8:].rstrip(b"\0") for each in listener.payloads)
            return names | {early} <= texts

        until("all have come", all_have_come, PATIENCE)
    assert set(listener.codes) <= {Code.SEVERAL_PUBLISHERS, Code.PUBLISHER_GONE}
    assert Code.SEVERAL_PUBLISHERS in listener.codes
