"""The server, read back by a client: the robot's topics as they came, and what is known."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import jsonschema  # type: ignore[import-untyped]
import pytest

from fretc.watch.publishing.choice import addresses, chosen
from fretc.watch.publishing.foxglove_server import SCHEMA, FoxgloveServer
from fretc.watch.publishing.publishing import Publisher, Publishing
from fretc.watch.sources.log import Log
from fretc.watch.sources.source import Arrival, Channel, ConnectionLost, Missed, Opened
from fretc.watch.watch import Watch
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.each import each
from tests.foxglove import Listened, listened
from tests.fretc.watch.sent import MS, START, Sent, Setting, plan_of

SOURCE = Log("run.mcap", follow=False)
TOPICS = ("/x", "/y", "/fretc/R1", "/fretc/R3")
DEFINED = Channel("/x", "cdr", "std_msgs/msg/Bool", "ros2msg", b"bool data\n")


@contextmanager
def published() -> Iterator[tuple[Watch, Publishing, str]]:
    """A watch, and the address at which it is published."""
    found = chosen(["foxglove:0"], SOURCE)
    assert not isinstance(found, Diagnostic), found
    (address,) = addresses(found)
    watch, publishing = Watch(plan_of(Setting(slow="y < 5"))), Publishing(found)
    try:
        yield watch, publishing, address
    finally:
        publishing.end(watch)


def take(watch: Watch, publishing: Publishing, *items: Arrival | Missed | ConnectionLost) -> None:
    for item in items:
        list(watch.take(item))
        publishing.take(item, watch)


def state(client: Listened, requirement: str) -> dict[str, object]:
    """The last that has come of it."""
    found = [a for a in client.of(Arrival) if a.channel.topic == f"/fretc/{requirement}"]
    return dict(json.loads(found[-1].payload)) if found else {}


def assert_all_fit(client: Listened) -> None:
    """Every state that has come fits the schema, with which it comes."""
    states = [a for a in client.of(Arrival) if a.channel.topic.startswith("/fretc/")]
    assert {arrival.channel.schema for arrival in states} == {json.dumps(SCHEMA).encode()}
    for payload in {arrival.payload for arrival in states}:
        jsonschema.validate(json.loads(payload), SCHEMA)


@pytest.mark.slow
def test_a_client_sees_the_topics_as_they_came_and_the_state_of_each_requirement() -> None:
    """Anyone who connects, at any time, has it within a period."""
    with published() as (watch, publishing, address), listened(address, *TOPICS) as client:
        client.wait("it is opened", lambda: client.of(Opened))
        at = iter(range(0, 10**6, 10))

        def robot(x: float, y: float) -> None:
            now = next(at)
            take(watch, publishing, Sent("/x", x, now).arrival, Sent("/y", y, now).arrival)

        def comes(level: str) -> bool:
            robot(9.0, 9.0)
            return state(client, "R1").get("level") == level

        client.wait("all is well", lambda: comes("OK"))
        robot(1.0, 9.0)
        client.wait("it is violated", lambda: comes("ERROR"))
        lost = ConnectionLost(START + next(at) * MS, Diagnostic(Code.ROBOT_NOT_REACHED, "gone"))
        take(watch, publishing, lost)
        client.wait("R3 is stale", lambda: state(client, "R3").get("level") == "STALE")
        assert state(client, "R3")["obligation_pending"] == "perhaps"
        assert state(client, "R1")["level"] == "ERROR"
        assert state(client, "R1")["verdict"] == "violated"
        raw = Arrival(DEFINED, b"\0\1\0\0\1", START + next(at) * MS, 5)

        def has_come() -> bool:
            publishing.take(raw, watch)
            return any(a.payload == raw.payload for a in client.of(Arrival))

        client.wait("it comes", has_come)
    assert_all_fit(client)
    passed = [arrival for arrival in client.of(Arrival) if arrival.channel.topic == "/x"]
    assert {arrival.channel for arrival in passed} == {Sent("/x", 9.0, 0).arrival.channel, DEFINED}
    assert {a.publish_time for a in passed if a.channel == DEFINED} == {raw.log_time}
    numbers = [json.loads(a.payload)["data"] for a in passed if a.channel != DEFINED]
    assert set(numbers) == {9.0, 1.0}


@pytest.mark.slow
def test_what_was_violated_before_a_clock_was_set_back_stays_red() -> None:
    with published() as (watch, publishing, address), listened(address, *TOPICS) as client:
        client.wait("it is opened", lambda: client.of(Opened))
        for at in (50_000, 50_020, 50_040):
            take(watch, publishing, Sent("/x", 1.0, at).arrival, Sent("/y", 9.0, at).arrival)
        times = iter(range(0, 40_000, 10))

        def robot() -> bool:
            now = next(times)
            late = [Sent(topic, 9.0, now).arrival for topic in ("/x", "/y")]
            shifted = [Arrival(a.channel, a.payload, a.log_time + 10**11, a.log_time) for a in late]
            take(watch, publishing, *shifted)
            return len(watch.runs) == 1 and bool(state(client, "R1"))

        client.wait("another run has begun", robot)
        client.wait("R1 is red", lambda: robot() and state(client, "R1")["level"] == "ERROR")
        assert watch.runs[0].verdicts["R1"] == "violated"
        assert watch.session.states()[1].verdict != "violated"
    assert_all_fit(client)


def problem(*words: str) -> Code:
    found = chosen(words, SOURCE)
    assert isinstance(found, Diagnostic), found
    return found.code


@each("word", ["", "rviz", "foxglove:", "foxglove:x", "foxglove:70000", "foxglove:::1:5", "ros1"])
def test_what_is_no_place_is_bad_usage(word: str) -> None:
    assert problem(word) is Code.BAD_USAGE


def test_a_log_takes_no_diagnostics() -> None:
    assert problem("diagnostics") is Code.BAD_USAGE


def test_a_port_that_is_taken_is_told_and_leaves_none_open() -> None:
    first = FoxgloveServer("127.0.0.1", 0)
    try:
        assert problem(f"foxglove:{first.port}") is Code.NOT_PUBLISHED
        assert problem("foxglove:no.such.host.invalid:0") is Code.NOT_PUBLISHED
    finally:
        first.close()


def test_one_that_is_named_twice_is_one() -> None:
    found = chosen(["foxglove:0", "foxglove:0"], SOURCE)
    assert not isinstance(found, Diagnostic)
    publishers: list[Publisher] = [*found]
    assert len(publishers) == 1
    publishers[0].close()


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "foxglove", None)
    assert problem("foxglove:0") is Code.MISSING_EXTRA
