"""What DDS tells of publishers, and what a watch makes of it; and what others may send."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from fretc.logs.messages.ros2_types import definitions, latest
from fretc.watch.source_choice import chosen
from fretc.watch.sources.dds import MOST_KINDS, Dds
from fretc.watch.sources.dds_domain import DdsWriter, Domain, join
from fretc.watch.sources.dds_types import (
    Offer,
    dds_topic,
    is_type,
    payloads_of,
    ros_topic,
    ros_type,
)
from fretc.watch.sources.source import Arrival, Diagnosing, Opened, Problem, Reconnected
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.rendering import render
from monitors.stop_supervisor import Status
from tests.dds import domain, environment
from tests.programs import needs_package
from tests.ros1 import until

ROOT = Path(__file__).parents[4]
BOOL = "std_msgs/msg/Bool"
TRUE, FALSE = b"\0\1\0\0\1\0\0\0", b"\0\1\0\0\0\0\0\0"
HASH, DEFINITION = [*definitions(BOOL).items()][-1]
_WRITER = f"""
import time
from fretc.logs.messages.ros2_types import definitions
from fretc.watch.sources.dds_domain import join
from fretc.watch.sources.dds_types import Offer
digest, definition = [*definitions({BOOL!r}).items()][-1]
writer = join().writer("/stop", Offer({BOOL!r}, digest, reliable=False), definition)
"""
ROBOT = f"""{_WRITER}
while True:
    writer.write({TRUE!r})
    time.sleep(0.005)
"""

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    with domain() as number:
        for name, value in environment(number).items():
            monkeypatch.setenv(name, value)
        yield number


class Listening:
    """A source, and what it has given."""

    def __init__(self, *topics: str) -> None:
        self.source = Dds()
        self.found: list[object] = []
        self._thread = Thread(target=self._run, args=(topics,), daemon=True)

    def _run(self, topics: tuple[str, ...]) -> None:
        self.found.extend(self.source.arrivals(topics))

    def __enter__(self) -> Listening:
        self._thread.start()
        until("it is opened", lambda: any(isinstance(each, Opened) for each in self.all()))
        return self

    def __exit__(self, *_: object) -> None:
        self.source.close()
        self._thread.join(10)
        assert not self._thread.is_alive()

    def all(self) -> list[object]:
        return [*self.found]

    def messages(self) -> list[Arrival]:
        return [each for each in self.all() if isinstance(each, Arrival)]

    def problems(self) -> list[Diagnostic]:
        return [each.diagnostic for each in self.all() if isinstance(each, Problem)]

    def says(self, code: Code) -> bool:
        return code in {each.code for each in self.problems()}

    def hears(self, count: int) -> None:
        until(f"{count} messages have come", lambda: len(self.messages()) >= count)


@pytest.fixture
def robot(here: int) -> Iterator[Domain]:
    found = join()
    assert isinstance(found, Domain)
    yield found
    found.close()


def read(writer: DdsWriter, readers: int = 1) -> DdsWriter:
    until("somebody reads", lambda: writer.readers >= readers)
    return writer


@pytest.mark.parametrize("reliable", [True, False])
@pytest.mark.parametrize("keeps", [True, False])
@pytest.mark.parametrize("described", [True, False])
def test_every_kind_of_publisher_is_read(
    robot: Domain, reliable: bool, keeps: bool, described: bool
) -> None:
    offer = Offer(BOOL, HASH, reliable, keeps, described)
    writer = robot.writer("/stop", offer, DEFINITION)
    if keeps:
        writer.write(FALSE, 7)
    with Listening("/stop") as listening:
        read(writer).write(TRUE, 8)
        listening.hears(2 if keeps and reliable else 1)
        writer.write(FALSE, 9)
        listening.hears(3 if keeps and reliable else 2)
    found = listening.messages()
    assert [(each.payload, each.publish_time) for each in found[-2:]] == [(TRUE, 8), (FALSE, 9)]
    assert len(found) == (3 if keeps and reliable else 2)
    times = [each.log_time for each in found]
    assert times == sorted(times)
    (channel,) = {each.channel for each in found}
    assert (channel.topic, channel.schema_name) == ("/stop", BOOL)
    assert channel.schema.decode() == DEFINITION
    assert not listening.problems()


def test_a_message_of_two_kinds_of_publishers_comes_once(robot: Domain) -> None:
    kinds = [Offer(BOOL, HASH, reliable) for reliable in (True, False)]
    writers = [robot.writer("/stop", each, DEFINITION) for each in kinds]
    with Listening("/stop") as listening:
        until("both readers are there", lambda: [each.readers for each in writers] == [2, 1])
        for i in range(20):
            for writer in writers:
                writer.write(TRUE, 1 + i)
        listening.hears(40)
    assert len(listening.messages()) == 40
    assert [each.code for each in listening.problems()] == [Code.SEVERAL_PUBLISHERS]


@contextmanager
def publishing(number: int, lease: str) -> Iterator[subprocess.Popen[bytes]]:
    """A robot that publishes all the time."""
    around = {**environment(number, lease), "PYTHONPATH": str(ROOT)}
    with subprocess.Popen([sys.executable, "-c", ROBOT], env=around, cwd=ROOT) as running:
        try:
            yield running
        finally:
            running.kill()


def test_a_publisher_that_ends_and_another_that_comes(here: int) -> None:
    with Listening("/stop") as listening:
        for _ in range(2):
            robot = join()
            assert isinstance(robot, Domain)
            writer = read(robot.writer("/stop", Offer(BOOL, HASH, reliable=True), DEFINITION))
            writer.write(TRUE)
            listening.hears(1)
            robot.close()
            until("it is gone", lambda: listening.problems(), 10)
            assert [each.code for each in listening.problems()] == [Code.PUBLISHER_GONE]
            listening.found.clear()
    assert not [each for each in listening.all() if isinstance(each, Reconnected)]


def test_what_a_publisher_sent_while_it_was_out_of_reach_was_missed(here: int) -> None:
    with publishing(here, "500 ms") as running, Listening("/stop") as listening:
        listening.hears(1)
        running.send_signal(signal.SIGSTOP)
        until("it is lost", lambda: listening.says(Code.PUBLISHER_GONE), 20)
        before = len(listening.messages())
        running.send_signal(signal.SIGCONT)
        listening.hears(before + 1)
    (gap,) = [each for each in listening.all() if isinstance(each, Reconnected)]
    arrived = [each.log_time for each in listening.messages()]
    assert gap.since <= arrived[before - 1] + 10**6
    assert arrived[before - 1] < gap.until <= arrived[before]


def test_what_is_known_is_published_as_a_node_does(here: int) -> None:
    said = Status(2, "fretc watch: R1", "violated \udc80", (("obligation_pending", "True"),))
    with Listening("/stop") as listening, Listening("/diagnostics") as hearing:
        listening.source.diagnose([said])
        hearing.hears(2)
    (channel,) = {each.channel for each in hearing.messages()}
    assert channel.schema_name == "diagnostic_msgs/msg/DiagnosticArray"
    assert channel.schema
    found = latest().deserialize_cdr(hearing.messages()[0].payload, channel.schema_name)
    assert found.header.stamp.sec * 10**9 <= hearing.messages()[0].log_time
    (status,) = found.status
    assert (status.level, status.name, status.message) == (2, said.name, "violated ?")
    assert [(each.key, each.value) for each in status.values] == [*said.values]
    assert isinstance(listening.source, Diagnosing)


# Strangers


OTHER_HASH = "RIHS01_" + "0" * 64


@pytest.mark.parametrize(
    ("type_", "digest", "why"),
    [
        (BOOL, OTHER_HASH, "the type hash differs"),
        ("my_msgs/msg/Own", OTHER_HASH, "is not a type of ROS 2 itself"),
        ("sensor_msgs/msg/Range", None, "differs between releases"),
    ],
)
def test_what_nobody_defines_is_told_of_and_handed_on(
    robot: Domain, type_: str, digest: str | None, why: str
) -> None:
    writer = robot.writer("/stop", Offer(type_, digest, reliable=True), DEFINITION)
    with Listening("/stop") as listening:
        read(writer).write(TRUE)
        listening.hears(1)
    (problem,) = listening.problems()
    assert problem.code is Code.NO_DEFINITION
    assert problem.is_error
    assert why in problem.message
    (message,) = listening.messages()
    assert (message.channel.schema_name, message.channel.schema) == (type_, b"")


def test_a_hash_tells_which_release_it_is(here: int) -> None:
    name = "sensor_msgs/msg/Range"
    found = definitions(name)
    assert len(found) > 1
    for digest, definition in found.items():
        robot = join()
        assert isinstance(robot, Domain)
        writer = robot.writer("/stop", Offer(name, digest, reliable=True), definition)
        with Listening("/stop") as listening:
            read(writer).write(TRUE)
            listening.hears(1)
        assert [each.channel.schema.decode() for each in listening.messages()] == [definition]
        robot.close()


def test_a_type_that_is_not_what_its_name_says_is_not_read(robot: Domain) -> None:
    from cyclonedds.topic import Topic

    other = [*definitions("sensor_msgs/msg/Joy").values()][-1]
    types = payloads_of("sensor_msgs/msg/Joy", other)
    offer = Offer(BOOL, reliable=True, described=True)
    types.__idl__.idl_transformed_typename = "std_msgs::msg::dds_::Bool_"
    topic: Any = Topic(robot._participant, "rt/stop", types)
    writer = DdsWriter(robot._participant, topic, offer)
    with Listening("/stop") as listening:
        until("it is reported", lambda: listening.says(Code.PUBLISHER_NOT_READ))
        assert writer.readers == 0
    assert all(each.is_error for each in listening.problems())


@pytest.mark.parametrize("described", [True, False])
def test_no_payload_takes_the_watch_down(robot: Domain, described: bool) -> None:
    name = "sensor_msgs/msg/LaserScan"
    digest, definition = [*definitions(name).items()][-1]
    stranger = robot.writer("/scan", Offer(name, digest, reliable=True), definition)
    payloads = [b"\0\1\0\0", b"\0\1\0\0\1", b"\xff" * 100, b"\0\1\0\0" + b"\xff" * 2**22]
    with Listening("/scan") as listening:
        read(stranger)
        for payload in payloads:
            stranger.write(payload)
        listening.hears(len(payloads))
    padded = [
        each.payload[: len(p)] for each, p in zip(listening.messages(), payloads, strict=True)
    ]
    assert padded == payloads
    assert not listening.problems()


BROKEN = f"""{_WRITER}
while not writer.readers:
    time.sleep(0.005)
for _ in range(20):
    writer.write(bytes.fromhex("80ff000000000000"))
"""


def test_packets_that_are_broken_leave_the_terminal_and_others_alone(
    robot: Domain, capfd: pytest.CaptureFixture[str]
) -> None:
    with Listening("/stop") as listening:
        around = {**os.environ, "PYTHONPATH": str(ROOT)}
        subprocess.run([sys.executable, "-c", BROKEN], env=around, cwd=ROOT, check=True, timeout=60)
        writer = robot.writer("/stop", Offer(BOOL, HASH, reliable=True), DEFINITION)
        read(writer).write(TRUE)
        until("the other is heard", lambda: TRUE in {each.payload for each in listening.messages()})
    assert capfd.readouterr().err == ""


NASTY = "\x1b[2Jwiped\r\n"


def test_names_of_strangers_never_reach_the_terminal_as_they_are(robot: Domain) -> None:
    from cyclonedds.idl import make_idl_struct
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    writers = []
    for type_ in (NASTY, "x" * 250):
        struct = make_idl_struct("M", type_, {"data": bool}, dataclassify=False)
        topic: Any = Topic(robot._participant, "rt/stop", struct)
        writers.append(DataWriter(robot._participant, topic))
    with Listening("/stop") as listening:
        until("it is reported", lambda: listening.says(Code.PUBLISHER_NOT_READ))
    texts = [render(each) for each in listening.problems()]
    assert not [text for text in texts if not text.replace("\n", "").isprintable()]


def test_kinds_without_end_are_not_read(robot: Domain) -> None:
    writers = [
        robot.writer("/stop", Offer(BOOL, f"RIHS01_{i:064x}", reliable=True), DEFINITION)
        for i in range(MOST_KINDS + 5)
    ]
    with Listening("/stop") as listening:
        until("it is reported", lambda: listening.says(Code.PUBLISHER_NOT_READ), 30)
    assert max(each.readers for each in writers) <= MOST_KINDS


# The place


def test_a_domain_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for text in ("x", "-1", "233", "1e3", "٣"):
        monkeypatch.setenv("ROS_DOMAIN_ID", text)
        (problem,) = [each for each in Dds().arrivals(["/x"]) if isinstance(each, Problem)]
        assert problem.diagnostic.code is Code.ROBOT_NOT_REACHED
        assert text in problem.diagnostic.message


def test_a_configuration_that_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    with domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        monkeypatch.setenv("CYCLONEDDS_URI", "<CycloneDDS><Nothing/></CycloneDDS>")
        (problem,) = [each for each in Dds().arrivals(["/x"]) if isinstance(each, Problem)]
    assert problem.diagnostic.code is Code.ROBOT_NOT_REACHED
    assert "CYCLONEDDS_URI" in (problem.diagnostic.help or "")


def test_without_the_package_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cyclonedds.domain", None)
    (problem,) = [each for each in Dds().arrivals(["/x"]) if isinstance(each, Problem)]
    assert problem.diagnostic.code is Code.MISSING_EXTRA
    assert problem.diagnostic.help == (
        f"{install_help('live')}; Cyclone DDS has no wheel for Python 3.14 and none for Linux on "
        "ARM64: there use `fretc watch foxglove` with a bridge"
    )


def test_words_and_names() -> None:
    assert isinstance(chosen(["dds"], follow=False), Dds)
    assert isinstance(chosen(["dds"], follow=True), Diagnostic)
    assert dds_topic("/scan") == "rt/scan"
    assert [ros_topic(each) for each in ("rt/scan", "rq/call", "plain")] == ["/scan", None, "plain"]
    assert ros_type("sensor_msgs::msg::dds_::LaserScan_") == "sensor_msgs/msg/LaserScan"
    assert ros_type("a::b") == "a::b"
    assert [is_type(each) for each in ("a/msg/B", "a::B", "", "a b", NASTY, "é")] == [
        True, True, False, False, False, False,
    ]  # fmt: skip
