"""The tables `[action.NAME]`: what an action publishes, and each mistake in them."""

import pytest

from fretish.bindings.declarations import ActionBinding
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
