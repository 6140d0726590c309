"""The operations of one client: what the protocol's specification says, and its limits."""

import json
from collections.abc import Mapping
from typing import Any

import pytest

from fretc.rosbridge.session import MOST_SUBSCRIPTIONS, MOST_TOPICS, Graph, Session


def added(request: Mapping[str, Any]) -> Mapping[str, Any]:
    if request.keys() != {"a", "b"}:
        raise ValueError("two numbers are needed")
    return {"sum": request["a"] + request["b"]}


class Talk:
    """A session with what it answers and what it publishes."""

    def __init__(self) -> None:
        self.published: list[tuple[str, str, Any]] = []
        self.replies: list[dict[str, Any]] = []
        types = {"/scan": "sensor_msgs/LaserScan"}
        self.graph = Graph(types, self.publish, {"/add": added, "/hang": lambda request: None})
        self.session = Session(self.graph, self.replies.append)

    def publish(self, topic: str, kind: str, message: Any) -> None:
        if message == {"data": 3}:
            raise ValueError("data is no bool")
        self.published.append((topic, kind, message))

    def says(self, **operation: Any) -> list[dict[str, Any]]:
        self.replies.clear()
        self.session.receive(json.dumps(operation))
        return self.replies


BOOL = {"topic": "/stop", "type": "std_msgs/Bool"}


def error(text: str, **more: Any) -> list[dict[str, Any]]:
    return [{"op": "status", "level": "error", "msg": text, **more}]


def test_an_advertised_topic_takes_messages() -> None:
    talk = Talk()
    assert talk.says(op="advertise", **BOOL) == []
    assert talk.says(op="publish", topic="/stop", msg={"data": True}) == []
    assert talk.says(op="publish", topic="stop", msg={"data": False}) == []
    assert talk.published == [
        ("/stop", "std_msgs/Bool", {"data": True}),
        ("/stop", "std_msgs/Bool", {"data": False}),
    ]


def test_what_is_not_advertised_or_does_not_conform_is_dropped_with_an_error() -> None:
    talk = Talk()
    assert talk.says(op="publish", topic="/stop", msg={}) == error("/stop is not advertised")
    talk.says(op="advertise", **BOOL)
    assert talk.says(op="publish", topic="/stop", msg={"data": 3}, id="p1") == error(
        "the message does not conform: data is no bool", id="p1"
    )
    assert talk.says(op="publish", topic="/stop", msg=3) == error("publish needs a message")
    talk.says(op="unadvertise", topic="/stop")
    assert talk.says(op="publish", topic="/stop", msg={}) == error("/stop is not advertised")
    assert talk.published == []


def test_a_topic_has_one_type() -> None:
    talk = Talk()
    text = "/scan has the type sensor_msgs/LaserScan, not std_msgs/Bool"
    for op in ("advertise", "subscribe"):
        assert talk.says(op=op, topic="/scan", type="std_msgs/Bool", id=1) == error(text, id=1)
        assert talk.says(op=op, topic="/scan", type="sensor_msgs/msg/LaserScan") == []


def test_a_subscription_without_a_type_needs_the_topic() -> None:
    talk = Talk()
    assert talk.says(op="subscribe", topic="/scan") == []
    assert talk.says(op="subscribe", topic="/none") == error(
        "/none does not exist, and its type is unknown"
    )
    assert [*talk.session.queues] == ["/scan"]


def test_unsubscribe_ends_one_subscription_or_all() -> None:
    talk = Talk()
    for id in ("a", "b", "c"):
        talk.says(op="subscribe", topic="/scan", id=id)
    assert talk.says(op="unsubscribe", topic="/scan", id="b") == []
    assert [*talk.session.queues["/scan"].subscriptions] == ["a", "c"]
    assert talk.says(op="unsubscribe", topic="/scan") == []
    assert talk.session.queues == {}


def test_warnings_are_sent_to_who_asks_for_them() -> None:
    talk = Talk()
    assert talk.says(op="unadvertise", topic="/stop") == []
    assert talk.says(op="set_level", level="warning") == []
    (status,) = talk.says(op="unadvertise", topic="/stop")
    assert (status["level"], status["msg"]) == ("warning", "/stop is not advertised")
    assert talk.says(op="set_level", level="none") == []
    assert talk.says(op="nonsense") == []


def test_a_service_answers_or_refuses_or_is_silent() -> None:
    talk, call = Talk(), {"op": "call_service", "service": "add", "id": 7}
    answer = {"op": "service_response", "service": "add", "id": 7}
    good = talk.says(**call, args={"a": 2, "b": 3})
    assert good == [{**answer, "values": {"sum": 5}, "result": True}]
    for wrong, why in (({"a": 2}, "two numbers are needed"), ([2, 3], "the arguments of a call")):
        (bad,) = talk.says(**call, args=wrong)
        assert bad["result"] is False
        assert bad["values"].startswith(why)
    assert talk.says(**{**call, "service": "/hang"}) == []


def test_a_call_of_no_service_fails() -> None:
    assert Talk().says(op="call_service", service="/rosapi/topics", id="call:1") == [
        {
            "op": "service_response",
            "service": "/rosapi/topics",
            "result": False,
            "values": "service '/rosapi/topics' does not exist",
            "id": "call:1",
        }
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "the operation is no JSON"),
        ("[" * 100_000, "the operation is no JSON"),
        ("3", "the operation is no JSON object"),
        (b"\xa0", "operations are JSON texts"),
        ("{}", "unknown operation None"),
        ('{"op": []}', "unknown operation []"),
        ('{"op": "subscribe"}', "the operation needs a topic"),
        ('{"op": "subscribe", "topic": 3}', "the operation needs a topic"),
        ('{"op": "advertise", "topic": "/a"}', "advertise needs a type"),
        ('{"op": "advertise", "topic": "/a", "type": 3}', "a type is a short text"),
        ('{"op": "x", "id": {}}', "an id is a short text or a whole number"),
        (f'{{"op": "x", "id": "{"i" * 300}"}}', "an id is a short text or a whole number"),
        ('{"op": "call_service"}', "call_service needs a service"),
        ('{"op": "set_level", "level": "loud"}', "unknown level 'loud'"),
        (
            '{"op": "subscribe", "topic": "/scan", "compression": "png"}',
            "compression 'png' is not supported",
        ),
        (
            '{"op": "subscribe", "topic": "/scan", "throttle_rate": -1}',
            "throttle_rate is a whole number, at most a million",
        ),
        (
            '{"op": "subscribe", "topic": "/scan", "queue_length": true}',
            "queue_length is a whole number, at most a million",
        ),
    ],
)
def test_a_wrong_operation_is_answered_and_nothing_else(text: str | bytes, message: str) -> None:
    talk = Talk()
    talk.session.receive(text)
    assert [reply["msg"] for reply in talk.replies] == [message]
    assert talk.session.queues == {}


def test_a_client_cannot_fill_the_memory() -> None:
    talk = Talk()
    for number in range(MOST_TOPICS + 10):
        talk.says(op="advertise", topic=f"/t{number}", type="std_msgs/Bool")
        talk.says(op="subscribe", topic=f"/t{number}", type="std_msgs/Bool")
        talk.says(op="subscribe", topic="/t0", id=f"s{number}")
    assert len(talk.session._advertised) == MOST_TOPICS
    assert len(talk.session.queues) == MOST_TOPICS
    assert len(talk.session.queues["/t0"].subscriptions) == MOST_SUBSCRIPTIONS
    talk.session.receive(json.dumps({"op": "o" * 10_000}))
    assert len(talk.replies[-1]["msg"]) < 400


def test_types_of_topics_that_nobody_uses_are_forgotten() -> None:
    talk = Talk()
    for number in range(MOST_TOPICS * 3):
        talk.says(op="advertise", topic=f"/t{number}", type="std_msgs/Bool")
        talk.says(op="unadvertise", topic=f"/t{number}")
        assert f"/t{number}" not in talk.graph.types
    talk.says(op="subscribe", topic="/a", type="std_msgs/Bool")
    other = Session(talk.graph, talk.replies.append)
    other.receive('{"op": "subscribe", "topic": "/a"}')
    talk.session.close()
    assert "/a" in talk.graph.types
    other.close()
    assert talk.graph.types == {"/scan": "sensor_msgs/LaserScan"}
