"""The tables of an agent: what its actions publish and call, its trace, and each mistake."""

import pytest

from fretish.bindings.declarations import ActionBinding, ServiceCall
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source

GOOD = """\
[action.stop_moving]
topic = "/stop"
type = "std_msgs/msg/Bool"
message = { data = true }
"""


def test_an_action_has_its_topic_its_type_and_its_message_in_json() -> None:
    declared, diagnostics = read_bindings(Source("b.toml", GOOD))
    assert diagnostics == ()
    assert declared is not None
    assert declared.actions == {
        "stop_moving": ActionBinding("stop_moving", "/stop", "std_msgs/Bool", '{"data":true}')
    }


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('topic = "/stop"\n', "", "`[action.stop_moving]` has no `topic`"),
        ("message = { data = true }\n", "", "`[action.stop_moving]` has no `message`"),
        ('"/stop"', '"/st op"', "`topic` must be a topic"),
        ('"/stop"', '"~/stop"', "`topic` must be a topic"),
        ('"/stop"', "3", "`topic` must be a topic in quotes"),
        ("std_msgs/msg/Bool", "Bool", "`Bool` is not a ROS type"),
        ("{ data = true }", "true", "`message` must be a table: `{ data = true }`"),
        ("data = true", "data = nan", "`message` must hold only what JSON can hold"),
        ("data = true", "data = [{ a = 2020-01-01 }]", "`message` must hold only what JSON can"),
        ("action.stop_moving", "action.Stop", "`Stop` is no action"),
        ("message", "massage", "F302 unknown field `massage`"),
    ],
)
def test_a_mistake_is_reported_and_the_action_left_out(old: str, new: str, message: str) -> None:
    assert old in GOOD
    declared, diagnostics = read_bindings(Source("b.toml", GOOD.replace(old, new)))
    assert message in "\n".join(map(render, diagnostics))
    assert declared is not None  # only what reads the actions is refused
    assert declared.actions == {}
    assert ("action", "") in declared.mistakes


def test_a_topic_has_one_type() -> None:
    other = GOOD.replace("stop_moving", "go").replace("Bool", "Int8")
    _, (mistake,) = read_bindings(Source("b.toml", f"{GOOD}{other}"))
    assert "the topic `/stop` has the type `std_msgs/Int8` here, and `std_msgs/Bool` for" in render(
        mistake
    )


CALL = """\
[call.grip]
service = "/gripper/close"
type = "std_srvs/srv/SetBool"
request = { data = true }
limit = "1 s"
"""
LEAST = '[call.grip]\nservice = "/gripper/close"\ntype = "std_srvs/Trigger"\n'


def test_a_call_has_its_service_its_request_and_its_limit() -> None:
    for text, expected in (
        (CALL, ServiceCall("grip", "/gripper/close", "std_srvs/SetBool", '{"data":true}', 10**9)),
        (LEAST, ServiceCall("grip", "/gripper/close", "std_srvs/Trigger", "{}", 400_000_000)),
    ):
        declared, diagnostics = read_bindings(Source("b.toml", text))
        assert diagnostics == ()
        assert declared is not None
        assert declared.calls == {"grip": expected}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('service = "/gripper/close"\n', "", "`[call.grip]` has no `service`"),
        ('type = "std_srvs/srv/SetBool"\n', "", "`[call.grip]` has no `type`"),
        ('"/gripper/close"', '"a b"', "`service` must be a topic"),
        ("std_srvs/srv/SetBool", "SetBool", "`SetBool` is not a ROS type"),
        ("{ data = true }", "3", "`request` must be a table: `{ data = true }`"),
        ('"1 s"', '"0 s"', "`limit` must be a duration above 0, at most 60 s"),
        ('"1 s"', '"61 s"', "`limit` must be a duration above 0, at most 60 s"),
        ('"1 s"', "1", "`limit` must be a duration above 0, at most 60 s"),
        ("call.grip", "call.Grip", "write `[call.stop_moving]`"),
        ("request", "args", "F302 unknown field `args`"),
    ],
)
def test_a_mistake_is_reported_and_the_call_left_out(old: str, new: str, message: str) -> None:
    assert old in CALL
    declared, diagnostics = read_bindings(Source("b.toml", CALL.replace(old, new)))
    assert message in "\n".join(map(render, diagnostics))
    assert declared is not None
    assert declared.calls == {}
    assert ("call", "") in declared.mistakes


def test_an_action_does_not_publish_and_call() -> None:
    both = f"{GOOD}{CALL.replace('grip', 'stop_moving')}"
    declared, (mistake,) = read_bindings(Source("b.toml", both))
    assert "`stop_moving` publishes a message, and calls a service" in render(mistake)
    assert declared is not None
    assert declared.calls == {}


@pytest.mark.parametrize("text", ["agent = 3\n", "[agent]\n", '[agent]\ntrace = "no topic"\n'])
def test_a_trace_that_is_no_topic_is_reported(text: str) -> None:
    declared, (mistake,) = read_bindings(Source("b.toml", text))
    assert mistake.code.number == "F303"
    assert declared is not None
    assert declared.agent_trace is None
    assert ("agent", "") in declared.mistakes
