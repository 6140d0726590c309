"""A Zenoh connection, step by step, with a session that does what the test says."""

from __future__ import annotations

import sys
import time
from threading import Event as Flag
from typing import Any

import pytest

from fretc.watch.sources.source import (
    Arrival,
    ConnectionLost,
    Idle,
    Missed,
    Opened,
    Problem,
    Reconnected,
)
from fretc.watch.zenoh import publishers as tokens
from fretc.watch.zenoh import zenoh
from fretc.watch.zenoh.keys import Token
from fretc.watch.zenoh.publishers import Publisher, Publishers
from fretc.watch.zenoh.session import OnMessage, OnToken, SessionError
from fretc.watch.zenoh.zenoh import Zenoh
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.messages import diagnostic
from tests.zenoh_peer import STRING, digest

HASH = digest("std_msgs/msg/String")
KEY = f"0/x/{STRING}/{HASH}"
NAME = f"@ros2_lv/0/ab/0/1/MP/%/%/a/%x/{STRING}/{HASH}/::,10:,:,:,,"


def attached(number: int, gid: int = 1) -> bytes:
    numbers = b"".join(each.to_bytes(8, "little") for each in (number, 7))
    return numbers + b"\x10" + bytes([gid]) * 16


class Fake:
    """A session; the test plays the other side."""

    def __init__(self, locator: str, patience: float) -> None:
        self.lost = Flag()
        self.answers: list[Flag] = []
        self.take: OnMessage = lambda key, payload, attached: None
        self.meet: dict[str, OnToken] = {}
        FAKES.append(self)

    def subscribe(self, key: str, on_message: OnMessage) -> None:
        self.take = on_message

    def follow(self, key: str, on_token: OnToken) -> None:
        self.meet[key.split("/")[9]] = on_token

    def ask(self, key: str, patience: float) -> Flag:
        self.answers.append(Flag())
        return self.answers[-1]

    def close(self) -> None:
        """Nothing."""


FAKES: list[Fake] = []


class Steps:
    """A source whose thread takes one step at a time."""

    def __init__(self) -> None:
        self.source = Zenoh("tcp/fake:1")
        self.session, self.connection = self.connect()

    def connect(self) -> tuple[Fake, Any]:
        session = Fake("", 1)
        connection = zenoh._Connection(session, 0, frozenset(["/x"]))  # type: ignore[arg-type]
        self.source._follow(connection)
        self.session, self.connection = session, connection
        return session, connection

    def answer(self) -> None:
        """Ask, and be answered."""
        self.connection.asked_at = float("-inf")
        self.source._look(self.connection)
        self.session.answers[-1].set()
        self.source._look(self.connection)

    def lose(self) -> None:
        self.session.lost.set()
        with pytest.raises(SessionError):
            self.source._look(self.connection)
        self.source._lost(diagnostic("zenoh_not_reached", locator="", why=""))

    def items(self) -> list[object]:
        """What has come since the last call."""
        found: list[object] = []
        while not isinstance(item := self.source._mailbox.take(), Idle):
            found.append(item)
        return found


@pytest.fixture
def steps() -> Steps:
    return Steps()


def test_it_is_open_once_the_other_side_has_answered(steps: Steps) -> None:
    assert steps.items() == []
    steps.answer()
    (item,) = steps.items()
    assert item == Opened("Zenoh at tcp/fake:1, domain 0")
    steps.answer()
    assert steps.items() == []


def test_what_was_lost_before_the_connection_is_back_is_told_then(steps: Steps) -> None:
    """Else its time would be taken for known, while the source is still gone."""
    steps.answer()
    steps.session.take(KEY, b"1", attached(1))
    steps.lose()
    steps.session.take(KEY, b"3", attached(3))
    steps.connect()
    steps.session.take(KEY, b"6", attached(6))
    kinds = [type(item) for item in steps.items()]
    assert kinds == [Opened, Arrival, ConnectionLost, Arrival, Arrival]
    steps.answer()
    back, missed = steps.items()
    assert isinstance(back, Reconnected)
    assert isinstance(missed, Missed)
    assert missed.count == 1 + 2
    steps.session.take(KEY, b"7", attached(7))
    assert [type(item) for item in steps.items()] == [Arrival]


def test_after_a_reconnection_a_new_publisher_has_sent_from_then_on(steps: Steps) -> None:
    steps.answer()
    steps.lose()
    steps.connect()
    steps.session.meet["%x"](NAME, True)
    steps.answer()
    steps.items()
    steps.session.take(KEY, b"3", attached(3))
    missed, _ = steps.items()
    assert isinstance(missed, Missed)
    assert missed.count == 2


def test_a_publisher_that_was_there_before_the_watch_has_lost_nothing(steps: Steps) -> None:
    steps.session.meet["%x"](NAME, True)
    steps.answer()
    steps.session.take(KEY, b"3", attached(3))
    assert [type(item) for item in steps.items()] == [Opened, Arrival]


def test_one_that_appears_during_the_watch_has_lost_what_it_sent_first(steps: Steps) -> None:
    steps.answer()
    steps.session.meet["%x"](NAME, True)
    steps.session.take(KEY, b"3", attached(3))
    _, missed, _ = steps.items()
    assert isinstance(missed, Missed)
    assert missed.count == 2


def test_tokens_that_end_with_the_connection_are_not_those_of_the_robot(steps: Steps) -> None:
    steps.session.meet["%x"](NAME, True)
    steps.answer()
    steps.session.meet["%x"](NAME, False)
    steps.lose()
    assert [type(item) for item in steps.items()] == [Opened, ConnectionLost]


def test_a_topic_is_gone_once_the_connection_has_outlived_its_last_publisher(steps: Steps) -> None:
    other = NAME.replace("/a/", "/b/")
    steps.session.meet["%x"](NAME, True)
    steps.session.meet["%x"](other, True)
    steps.answer()
    steps.session.meet["%x"](NAME, False)
    steps.answer()
    steps.session.meet["%x"](other, False)
    codes = [item.diagnostic.code for item in steps.items() if isinstance(item, Problem)]
    assert codes == [Code.SEVERAL_PUBLISHERS]
    steps.answer()
    steps.answer()
    (item,) = steps.items()
    assert isinstance(item, Problem)
    assert item.diagnostic.code is Code.PUBLISHER_GONE


def test_an_other_side_that_answers_no_question_is_watched(
    steps: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A router may refuse questions: then the transport alone says whether it is there."""
    monkeypatch.setattr(zenoh, "PATIENCE", 0.0)
    monkeypatch.setattr(zenoh, "_PING", 0.0)
    steps.session.meet["%x"](NAME, True)
    for _ in range(4):
        time.sleep(0.001)
        steps.source._look(steps.connection)
    steps.session.meet["%x"](NAME, False)
    for _ in range(3):
        time.sleep(0.001)
        steps.source._look(steps.connection)
    opened, gone = steps.items()
    assert isinstance(opened, Opened)
    assert isinstance(gone, Problem)
    assert len(steps.session.answers) == 1
    steps.lose()


def test_one_that_has_answered_and_does_not_any_more_is_lost(
    steps: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps.answer()
    monkeypatch.setattr(zenoh, "PATIENCE", 0.0)
    steps.connection.asked_at = float("-inf")
    steps.source._look(steps.connection)
    time.sleep(0.001)
    with pytest.raises(SessionError, match="not answered"):
        steps.source._look(steps.connection)


def test_messages_without_number_are_missed_when_their_publisher_returns(steps: Steps) -> None:
    steps.answer()
    steps.session.meet["%x"](NAME, True)
    steps.session.take(KEY, b"1", b"")
    steps.session.meet["%x"](NAME, False)
    steps.answer()
    steps.session.meet["%x"](NAME, True)
    _, problem, arrival, gone, back = steps.items()
    assert isinstance(problem, Problem)
    assert problem.diagnostic.code is Code.UNNUMBERED
    assert isinstance(arrival, Arrival)
    assert isinstance(gone, Problem)
    assert isinstance(back, Reconnected)
    assert back.since == arrival.log_time


def test_a_name_that_is_none_of_ros_is_reported(steps: Steps) -> None:
    assert steps.source._named(["/x", "/a*", "b//c"]) == {"/x"}
    problems = [item for item in steps.items() if isinstance(item, Problem)]
    assert [item.diagnostic.code for item in problems] == [Code.PUBLISHER_NOT_READ] * 2


@pytest.mark.parametrize("name", ["zenoh", "rosbags.typesys"])
def test_a_missing_package_is_one_error(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from fretc.logs.messages import ros2_types

    monkeypatch.setattr(ros2_types, "_stores", ros2_types._stores.__wrapped__)  # without its cache
    monkeypatch.setitem(sys.modules, name, None)
    (item,) = Zenoh("tcp/127.0.0.1:1").arrivals(["/x"])
    assert isinstance(item, Problem)
    assert item.diagnostic.code is Code.MISSING_EXTRA
    assert "fretc[zenoh]" in (item.diagnostic.help or "")


def test_the_number_of_publishers_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tokens, "MOST_TOKENS", 2)
    found = Publishers()
    for name in "abc":
        found.appear(name, Publisher("/x", Token(name, KEY), 1, is_early=False))
    assert (found.nodes("/x"), found.count("/x"), found.count(KEY)) == (["a", "b"], 2, 2)
    found.disappear("a", 5)
    found.disappear("c", 5)
    found.appear("d", Publisher("/x", Token("d", KEY), 6, is_early=False))
    assert (found.nodes("/x"), found.count("/x"), found.count(KEY)) == (["b", "d"], 2, 2)
    assert found.ended(9) == []
    found.disappear("b", 7)
    found.disappear("d", 8)
    assert [each.token.node for each in found.ended(7)] == ["b"]
    assert (found.nodes("/x"), found.count("/x")) == (["d"], 1)
    assert [each.token.node for each in found.ended(8)] == ["d"]
    assert (found.nodes("/x"), found.count("/x"), found.count(KEY)) == ([], 0, 0)
    assert found.since(KEY) == 1


def test_a_second_publisher_does_not_make_the_first_one_new(steps: Steps) -> None:
    steps.session.meet["%x"](NAME, True)
    steps.answer()
    steps.session.meet["%x"](NAME.replace("/a/", "/b/"), True)
    steps.session.take(KEY, b"3", attached(3))
    assert Missed not in {type(item) for item in steps.items()}
