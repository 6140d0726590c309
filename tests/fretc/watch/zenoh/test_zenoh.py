"""`fretc watch zenoh`: what it says is what an audit says, no matter who the other side is."""

import json
import os
import signal
import socket
from contextlib import suppress
from pathlib import Path
from threading import Thread

import pytest

from fretc.watch.sources.mailbox import Mailbox
from fretc.watch.sources.source import (
    Arrival,
    ConnectionLost,
    Idle,
    Missed,
    Opened,
    Problem,
    Reconnected,
)
from fretc.watch.zenoh import zenoh
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
    digest,
    free_port,
    listened,
    mangled,
    peer,
)

ROOT = Path(__file__).parents[4]
LOG = ROOT / "traces/mission-seed15.mcap"
TYPES = {"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry"}
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
    "case",
    [
        ("px4_msgs::msg::dds_::VehicleStatus_", HASH, "not a type of ROS 2 itself"),
        (STRING, HASH.replace("df", "fd"), "the type hash differs"),
        ("sensor_msgs::msg::dds_::Range_", NO_HASH, "no type hash"),
        ("strange", "1", "not a type of ROS 2 itself"),
    ],
)
def test_messages_without_definition_are_recorded_and_reported(case: tuple[str, str, str]) -> None:
    type_, digest_, why = case
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
    """What was sent meanwhile is unknown; what a new publisher sent before is known to be lost."""
    port = free_port()
    with peer(port) as robot:
        found = Listened(robot.locator)
        opened(found)
        robot.publish("x", gid="aa" * 16)
        robot.send("x", b"1")
        found.wait("it comes", lambda: found.payloads == [b"1"])
    try:
        found.wait("it is lost", lambda: found.of(ConnectionLost))
        with peer(port) as robot:
            robot.publish("x", gid="aa" * 16)
            found.wait("it is back", lambda: found.of(Reconnected))
            robot.send("x", b"5", number=5)
            robot.send("x", b"6", number=6)
            found.wait("they come", lambda: found.payloads == [b"1", b"5", b"6"])
            assert found.codes == []
    finally:
        found.source.close()
        found.thread.join(10)
    (lost,), (back,), (missed,) = found.of(ConnectionLost), found.of(Reconnected), found.of(Missed)
    assert lost.problem.code is Code.ROBOT_NOT_REACHED
    first, second, _ = found.of(Arrival)
    assert first.log_time < lost.since <= back.since < back.until
    assert (missed.since, missed.until < second.log_time, missed.count) == (missed.since, True, 3)
    assert first.log_time < missed.since <= lost.since


def test_a_peer_that_no_longer_answers_is_lost() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x")
        robot.send("x", b"1")
        found.wait("it comes", lambda: found.payloads)
        robot.process.send_signal(signal.SIGSTOP)
        try:
            found.wait("it is lost", lambda: found.of(ConnectionLost))
        finally:
            robot.process.send_signal(signal.SIGCONT)
        found.wait("it is back", lambda: found.of(Reconnected))
        robot.send("x", b"2")
        found.wait("the next comes", lambda: found.payloads[-1:] == [b"2"])
    (lost,) = found.of(ConnectionLost)
    assert "has not answered for 3 s" in lost.problem.message
    assert found.codes == []


def test_a_closed_watch_ends_although_the_peer_does_not_answer() -> None:
    with peer() as robot:
        with listened(robot.locator) as found:
            opened(found)
            robot.process.send_signal(signal.SIGSTOP)
        assert not found.thread.is_alive()
        robot.process.send_signal(signal.SIGCONT)


# Other servers


def test_strange_keys_and_tokens_are_ignored() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        for key in ("**", "0/**", "0/x/**", "0/x/*/*", f"0/x/{STRING}/*", "0/*/a/b", "0/x/a$*c/b"):
            robot.ask("put", key=key, data=b"wild")
        robot.ask("delete", key=KEY)
        for name in (token("n" * 300), token(kind="MS"), token().replace("/MP/", "/mp/")):
            robot.ask("token", key=name)
        robot.publish("x")
        robot.send("x", b"1")
        found.wait("it comes", lambda: b"1" in found.payloads)
    assert found.payloads == [b"1"]
    assert found.codes == [Code.PUBLISHER_NOT_READ]


def test_many_types_of_a_topic_are_not_read() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        for number in range(zenoh.MOST_KINDS + 5):
            robot.ask("put", key=f"0/x/T{number}/h", data=b"%d" % number)
        found.wait("it is said", lambda: Code.PUBLISHER_NOT_READ in found.codes)
        assert len({item.channel for item in found.of(Arrival)}) == zenoh.MOST_KINDS
    assert found.codes.count(Code.PUBLISHER_NOT_READ) == 1


def test_a_message_of_more_than_64_mib_is_missed() -> None:
    with peer() as robot, listened(robot.locator) as found:
        opened(found)
        robot.publish("x")
        robot.send("x", b"1")
        robot.send("x", b"\0" * (2**26 + 1))
        robot.send("x", b"3")
        found.wait("the next comes", lambda: len(found.payloads) > 1)
    assert found.payloads == [b"1", b"3"]
    assert [item.count for item in found.of(Missed)] == [1]


def test_a_flood_is_limited_and_what_is_dropped_is_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The watch reads nothing until all is sent."""
    count, most = 2000, 50
    with peer() as robot:
        source = zenoh.Zenoh(robot.locator)
        source._mailbox = Mailbox(most)
        arrivals = source.arrivals(["/x"])
        items: list[object] = []
        while not any(isinstance(item, Opened) for item in items):
            items.append(next(arrivals))
        robot.publish("x")
        robot.ask("flood", name="x", data=b"x", count=count)
        until("all are there", lambda: next(iter(source._numbers._last.values())).number == count)
        while not isinstance(items[-1], Idle):
            items.append(next(arrivals))
        robot.send("x", b"last")
        while not (isinstance(items[-1], Arrival) and items[-1].payload == b"last"):
            items.append(next(arrivals))
        arrivals.close()
    came = [item for item in items if isinstance(item, Arrival)]
    missed = [item for item in items if isinstance(item, Missed)]
    assert len(came) + sum(item.count for item in missed) == count + 1
    assert len(came) <= most + 1


# Live verdicts equal those of the audit


@pytest.mark.parametrize("lost", [False, True])
def test_the_watch_and_the_audit_agree(fretc: Fretc, tmp_path: Path, lost: bool) -> None:
    """A part of a mission, in real time: a stop, and the robot that stands.

    A lost message makes its time unknown, and the run satisfies nothing.
    """
    requirements = ["--requirements", str(ROOT / "requirements/r1.fret")]
    environment = {key: value for key, value in os.environ.items() if key != "ROS_DOMAIN_ID"}
    with peer() as robot:
        words = ("--record", "run.mcap", "--evidence", "live.json")
        run = Watched(environment, tmp_path, "zenoh", robot.locator, *requirements, *words)
        try:
            until("it is opened", lambda: any(x["type"] == "opened" for x in run.lines), 30)
            for topic, type_ in TYPES.items():
                robot.publish(topic, topic, type=mangled(type_), hash=digest(type_))
            robot.ask("play", part=[str(LOG), 5.0, 6.5], skip=7 if lost else 0)
            until("it was triggered", lambda: any(line.get("triggered_ns") for line in run.lines))
            status = run.end()
        finally:
            run.close()
    again = fretc("audit", "run.mcap", *requirements, "-o", "audit.json")
    assert again.status == status, (again.err, run.lines)
    assert (tmp_path / "audit.json").read_bytes() == (tmp_path / "live.json").read_bytes()
    (result,) = json.loads((tmp_path / "audit.json").read_text())["results"]
    assert run.verdicts() == {"R1": result["verdict"]}
    assert result["triggers"]
    assert any(line["type"] == "missed" for line in run.lines) == lost
