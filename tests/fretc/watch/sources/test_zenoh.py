"""`fretc watch zenoh`: what it says is what an audit says, no matter who the other side is."""

import json
import os
import signal
import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from fretc.watch.sources import zenoh
from fretc.watch.sources.mailbox import Mailbox
from fretc.watch.sources.source import (
    Arrival,
    ConnectionLost,
    Missed,
    Opened,
    Problem,
    Reconnected,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc
from tests.each import each
from tests.fretc.watch.watched import Watched
from tests.programs import needs_package
from tests.ros1 import until
from tests.zenoh_peer import (
    NO_HASH,
    STRING,
    Listened,
    Peer,
    digest,
    free_port,
    listened,
    mangled,
    peer,
)

ROOT = Path(__file__).parents[4]
LOG = ROOT / "traces/mission-seed15.mcap"
HASH = digest("std_msgs/msg/String")
KEY = f"0/x/{STRING}/{HASH}"

pytestmark = [pytest.mark.slow, needs_package("zenoh")]


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zenoh, "PATIENCE", 3.0)
    monkeypatch.setattr(zenoh, "_PING", 0.05)


def opened(found: Listened) -> None:
    found.wait("it is open", lambda: found.of(Opened))


def token(node: str = "a", topic: str = "%x", kind: str = "MP") -> str:
    return f"@ros2_lv/0/ab/0/1/{kind}/%/%/{node}/{topic}/{STRING}/{HASH}/::,10:,:,:,,"


# A peer that speaks as rmw_zenoh


def test_messages_come_with_type_and_send_time() -> None:
    with peer() as robot, listened(robot.locator, "/x", "/a/b") as found:
        opened(found)
        robot.publish("x")
        robot.publish("y", "/a/b", type=mangled("std_msgs/msg/Int32"), hash=NO_HASH)
        robot.publish("elsewhere", domain=1)
        robot.publish("unbound", "/c")
        robot.send("elsewhere")
        robot.send("unbound")
        robot.send("x", b"one", time=5)
        robot.send("y", b"two", time=0)
        found.wait("both are there", lambda: len(found.payloads) == 2)
    one, two = sorted(found.of(Arrival), key=lambda item: item.payload)
    assert (one.payload, one.publish_time) == (b"one", 5)
    assert one.channel.topic == "/x"
    assert one.channel.message_encoding == "cdr"
    assert one.channel.schema_name == "std_msgs/msg/String"
    assert one.channel.schema == b"string data\n"
    assert (two.payload, two.publish_time) == (b"two", two.log_time)
    assert two.channel.schema_name == "std_msgs/msg/Int32"
    assert found.codes == []


def test_a_late_watch_gets_what_publishers_keep() -> None:
    with peer() as robot:
        robot.publish("x", keeps=2)
        for text in (b"1", b"2", b"3"):
            robot.send("x", text)
        with listened(robot.locator) as found:
            found.wait("they come", lambda: len(found.payloads) == 2)
            opened(found)
            robot.send("x", b"4")
            found.wait("the next comes", lambda: len(found.payloads) == 3)
    assert found.payloads == [b"2", b"3", b"4"]
    assert found.of(Missed) == []


def test_lost_messages_are_known_by_their_numbers() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x")
        robot.send("x", b"1")
        robot.send("x", b"4", number=4)
        robot.send("x", b"5")
        found.wait("all are there", lambda: len(found.payloads) == 3)
    first, second, third = found.of(Arrival)
    (missed,) = found.of(Missed)
    assert missed.count == 2
    assert first.log_time < missed.since <= missed.until < second.log_time < third.log_time
    assert found.items.index(first) < found.items.index(missed) < found.items.index(second)


def test_two_publishers_number_for_themselves_and_are_reported() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("one", node="left")
        robot.publish("two", node="right")
        for name in ("one", "two", "two", "one"):
            robot.send(name)
        found.wait("all are there", lambda: len(found.payloads) == 4)
        found.wait("it is said", lambda: found.codes)
    (problem,) = found.of(Problem)
    assert problem.diagnostic.code is Code.SEVERAL_PUBLISHERS
    assert "/left" in problem.diagnostic.message
    assert "/right" in problem.diagnostic.message
    assert found.of(Missed) == []


def test_a_topic_without_publisher_and_its_return() -> None:
    """What was sent in between may be lost: DDS and Zenoh do not tell a stop from a cable."""
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x", token=False)
        robot.ask("token", key=token())
        robot.send("x", b"1")
        found.wait("it comes", lambda: found.payloads)
        robot.ask("drop", key=token())
        found.wait("it is said", lambda: found.codes)
        robot.ask("token", key=token())
        found.wait("it is back", lambda: found.of(Reconnected))
    assert found.codes == [Code.PUBLISHER_GONE]
    (arrival,), (back,) = found.of(Arrival), found.of(Reconnected)
    assert arrival.log_time <= back.since <= arrival.log_time + 10**6
    assert back.until > back.since


def test_simulated_time_is_reported_once() -> None:
    with peer() as robot, listened(robot.locator, "/x") as found:
        opened(found)
        robot.ask("token", key=token("a", "%clock"))
        robot.ask("token", key=token("b", "%clock"))
        robot.publish("x")
        robot.send("x")
        found.wait("it comes", lambda: found.payloads)
    assert found.codes == [Code.SIMULATED_TIME]


@each(
    ("type_", "digest_", "why"),
    [
        ("px4_msgs::msg::dds_::VehicleStatus_", HASH, "not a type of ROS 2 itself"),
        (STRING, HASH.replace("df", "fd"), "the type hash differs"),
        ("sensor_msgs::msg::dds_::CameraInfo_", NO_HASH, "no type hash"),
        ("strange", "1", "not a type of ROS 2 itself"),
    ],
)
def test_messages_without_definition_are_recorded_and_reported(
    type_: str, digest_: str, why: str
) -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x", type=type_, hash=digest_)
        robot.send("x", b"1")
        robot.send("x", b"2")
        found.wait("they come", lambda: found.payloads == [b"1", b"2"])
    (problem,) = found.of(Problem)
    assert problem.diagnostic.code is Code.NO_DEFINITION
    assert problem.diagnostic.is_error
    assert why in problem.diagnostic.message
    (channel,) = {item.channel for item in found.of(Arrival)}
    assert channel.schema == b""


@each("attached", [b"", b"\0" * 33, b"\0" * 200, b"\xff" * 33])
def test_messages_without_number_have_the_receive_time(attached: bytes) -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x")
        robot.send("x", b"1", attachment=attached)
        robot.send("x", b"2", attachment=attached)
        found.wait("they come", lambda: len(found.payloads) == 2)
    assert [item.publish_time == item.log_time for item in found.of(Arrival)] == [True, True]
    assert found.codes == [Code.UNNUMBERED]
    assert found.of(Missed) == []


# The connection


def test_without_a_router_there_is_one_error() -> None:
    problem = only_problem(f"tcp/127.0.0.1:{free_port()}")
    assert "rmw_zenohd" in (problem.help or "")


def only_problem(locator: str) -> Diagnostic:
    """What is said of another side that was never there, and the end of it."""
    found = Listened(locator)
    found.thread.join(30)
    assert not found.thread.is_alive()
    (item,) = found.items
    assert isinstance(item, Problem)
    assert item.diagnostic.code is Code.ROBOT_NOT_REACHED
    assert item.diagnostic.is_error
    assert locator in item.diagnostic.message
    assert "/src/" not in item.diagnostic.message
    return item.diagnostic


@each("answer", [b"", b"\0" * 5000, b"HTTP/1.1 200 OK\r\n\r\n", b"\xff" * 70_000, None])
def test_what_is_no_router_is_one_error(answer: bytes | None) -> None:
    """None: it never answers."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        kept = []

        def serve() -> None:
            with suppress(OSError):
                while True:
                    connection, _ = listening.accept()
                    kept.append(connection)
                    if answer is not None:
                        connection.sendall(answer)
                        connection.close()

        thread = Thread(target=serve, daemon=True)
        thread.start()
        only_problem(f"tcp/127.0.0.1:{listening.getsockname()[1]}")
        listening.shutdown(socket.SHUT_RDWR)
        thread.join(5)
        for each_ in kept:
            each_.close()


def test_a_wrong_domain_is_one_error(monkeypatch: pytest.MonkeyPatch) -> None:
    source = zenoh.Zenoh("tcp/127.0.0.1:1")
    monkeypatch.setenv("ROS_DOMAIN_ID", "many")
    (item,) = source.arrivals(["/x"])
    assert isinstance(item, Problem)
    assert "ROS_DOMAIN_ID" in item.diagnostic.message


def test_a_lost_peer_is_tried_again() -> None:
    with listened_later() as (found, port):
        with peer(port) as robot:
            robot.publish("x")
            robot.send("x", b"1")
        found.wait("it is back", lambda: found.of(Reconnected))
    (lost,), (back,) = found.of(ConnectionLost), found.of(Reconnected)
    assert lost.problem.code is Code.ROBOT_NOT_REACHED
    (before,) = [item for item in found.of(Arrival) if item.payload == b"0"]
    assert before.log_time < lost.since
    assert lost.since <= back.since < back.until
    assert Code.PUBLISHER_GONE not in found.codes


def listened_later() -> Any:
    raise NotImplementedError
