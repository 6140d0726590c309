"""Definitions that only a robot's nodes have, asked over Zenoh; and answers that lie."""

from __future__ import annotations

import pytest

from fretc.logs.messages.definitions import types
from fretc.logs.messages.ros2_types import definitions
from fretc.watch.sources.dds_types import Offer
from fretc.watch.sources.source import Arrival, Missed, Opened, Problem
from fretc.watch.sources.type_service import MOST_QUESTIONS, request
from fretc.watch.zenoh import zenoh
from fretc.watch.zenoh.keys import Attachment, Kind, attached, attachment
from fretc.watch.zenoh.type_questions import MOST_HELD, Held, TypeQuestions
from fretish.diagnostics.diagnostic import Code
from tests.fretc.watch.sources.test_type_service import answer
from tests.programs import needs_package
from tests.zenoh_peer import Listened, Peer, digest, listened, mangled, peer

SCAN, ODOMETRY = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
SERVICE = "type_description_interfaces::srv::dds_::GetTypeDescription_/RIHS01_" + "7" * 64


def test_an_attachment_is_read_as_it_was_written() -> None:
    for of in (Attachment(3, 5, bytes(range(16))), Attachment(0, None, b"\1" * 16)):
        assert attachment(attached(of)) == of


def test_messages_wait_for_the_last_answer_and_not_without_bounds() -> None:
    questions, message = TypeQuestions(), Held("/x", b"", b"")
    kind = Kind("a/msg/A", "RIHS01_1")
    assert questions.may_ask("0/x")
    assert not questions.holds("0/x", message)
    questions.ask(0, "0/x", kind, ["/one", "/two", "no name", "/**"])
    assert not questions.may_ask("0/x")
    (question,) = questions.unsent()
    assert questions.unsent() == []
    assert question.services == [f"0/{each}/get_type_description/*/*" for each in ("one", "two")]
    for _ in range(MOST_HELD + 5):
        assert questions.holds("0/x", message)
    assert questions.end(question) == []
    assert len(questions.end(question)) == MOST_HELD
    assert not questions.holds("0/x", message)
    assert questions.definition("0/x") is None
    for number in range(2 * MOST_QUESTIONS):
        if questions.may_ask(str(number)):
            questions.ask(0, str(number), kind, ["/one"] if number % 2 else [])
    assert len(questions.unsent()) == 49  # each second of the 99 that are left
    questions.drop()
    assert questions.end(question) == []


def send(robot: Peer, found: Listened, number: int) -> None:
    """Three messages of a node that describes the type."""
    found.wait("it is open", lambda: found.of(Opened))
    robot.publish("x", type=mangled(SCAN), hash=digest(SCAN))
    for text in (b"1", b"2", b"3"):
        robot.send("x", text)
    found.wait("they come", lambda: len(found.payloads) >= number)
    assert found.payloads == [b"1", b"2", b"3"]
    assert found.of(Missed) == []


@pytest.mark.slow
@needs_package("zenoh")
@pytest.mark.parametrize(
    ("answered", "known"), [(SCAN, True), (ODOMETRY, False), ("", False), (None, False)]
)
def test_a_type_that_fretc_does_not_know_is_asked_of_its_node(
    monkeypatch: pytest.MonkeyPatch, *, answered: str | None, known: bool
) -> None:
    """Of a node that lies, or does not answer, the messages are unknown, and none is lost."""
    monkeypatch.setattr(zenoh, "definition", lambda type_, digest: None)
    monkeypatch.setattr(zenoh, "_ANSWERS", 1.0)
    with peer() as robot, listened(robot.locator, "/x") as found:
        if answered is not None:
            robot.ask(
                "serve",
                key=f"0/talker/get_type_description/{SERVICE}",
                request=request(Offer(SCAN, digest(SCAN))),
                data=answer(answered) if answered else b"",
            )
        send(robot, found, 3)
    (channel,) = {each.channel for each in found.of(Arrival)}
    assert channel.schema_name == SCAN
    if known:
        (standard,) = definitions(SCAN).values()
        own = types(SCAN, channel.schema.decode(), ros1=False)
        assert own == types(SCAN, standard, ros1=False)
        assert found.codes == []
    else:
        assert channel.schema == b""
        (problem,) = found.of(Problem)
        assert problem.diagnostic.code is Code.NO_DEFINITION
