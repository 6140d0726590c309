"""The part of ROS 2's launch that emitted launch files use, played without processes.

The contract, of launch and launch_ros: an action that is executed may register handlers of events;
`OnProcessStart` acts each time that the process of its action starts, a respawn among it;
`OnStateTransition` acts where its lifecycle node goes from its start state to its goal state;
`ChangeState` asks the nodes that its matcher accepts for a transition. An event before which its
handler was not registered is lost.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from tests.ros2.rclpy import LifecycleNode

_TRANSITIONS = {1: "configure", 2: "cleanup", 3: "activate", 4: "deactivate"}
"""The numbers of lifecycle_msgs/Transition."""
_PASSING = {"configure": "configuring", "cleanup": "cleaningup"}
_PASSING |= {"activate": "activating", "deactivate": "deactivating"}


@dataclass(eq=False)
class Action:
    """Anything that a launch file makes: its kind, and what it was made of."""

    kind: str
    places: tuple[Any, ...]
    names: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        try:
            return self.names[name]
        except KeyError:
            raise AttributeError(name) from None


def _maker(kind: str, *known: str) -> Callable[..., Action]:
    def make(*places: Any, **names: Any) -> Action:
        unknown = set(names) - set(known)
        assert not unknown, f"TypeError: {kind} has no {unknown}"
        return Action(kind, places, names)

    return make


_PROCESS = (
    "package executable name namespace output respawn respawn_delay parameters remappings".split()
)
_CONTENT: Mapping[str, Mapping[str, Sequence[str]]] = {
    "launch": {"LaunchDescription": ()},
    "launch.actions": {
        "DeclareLaunchArgument": ("default_value", "description"),
        "EmitEvent": ("event",),
        "RegisterEventHandler": (),
    },
    "launch.event_handlers": {"OnProcessStart": ("target_action", "on_start")},
    "launch.substitutions": {"LaunchConfiguration": (), "PathJoinSubstitution": ()},
    "launch_ros.actions": {"LifecycleNode": _PROCESS, "Node": _PROCESS},
    "launch_ros.event_handlers": {
        "OnStateTransition": ("target_lifecycle_node", "start_state", "goal_state", "entities")
    },
    "launch_ros.events.lifecycle": {"ChangeState": ("lifecycle_node_matcher", "transition_id")},
    "launch_ros.substitutions": {"FindPackageShare": ()},
}


def modules() -> dict[str, ModuleType]:
    """The modules that a launch file imports."""
    found = {
        name: ModuleType(name) for name in ("launch_ros", "launch_ros.events", "launch.events")
    }
    vars(found["launch.events"])["matches_action"] = lambda action: lambda other: other is action
    for name, makers in _CONTENT.items():
        found[name] = ModuleType(name)
        vars(found[name]).update({kind: _maker(kind, *known) for kind, known in makers.items()})
    numbers = {f"TRANSITION_{label.upper()}": number for number, label in _TRANSITIONS.items()}
    found["lifecycle_msgs"] = ModuleType("lifecycle_msgs")
    found["lifecycle_msgs.msg"] = ModuleType("lifecycle_msgs.msg")
    vars(found["lifecycle_msgs.msg"])["Transition"] = SimpleNamespace(**numbers)
    return found


class Launch:
    """A description that is executed; processes start when a test says so."""

    def __init__(self, description: Action) -> None:
        self.actions: Sequence[Action] = description.places[0]
        self.nodes: dict[int, LifecycleNode] = {}

    def of(self, kind: str) -> list[Action]:
        """The actions of a kind, in their order."""
        return [each for each in self.actions if each.kind == kind]

    def _handlers(self, kind: str, before: Action) -> list[Action]:
        registered = self.actions[: self.actions.index(before)]
        found = [each.places[0] for each in registered if each.kind == "RegisterEventHandler"]
        return [each for each in found if each.kind == kind]

    def start(self, action: Action, node: LifecycleNode) -> None:
        """The process of an action starts, with this node in it; perhaps again."""
        self.nodes[id(action)] = node
        for handler in self._handlers("OnProcessStart", action):
            if handler.target_action is action:
                self._emit(handler.on_start)

    def change(self, action: Action, transition: str) -> None:
        """A managed node is asked for a transition: by the launch file, or by an operator."""
        node = self.nodes[id(action)]
        if not node.change(transition):
            return
        for handler in self._handlers("OnStateTransition", action):
            places = handler.start_state, handler.goal_state
            if handler.target_lifecycle_node is action and places == (
                _PASSING[transition],
                node.state,
            ):
                self._emit(handler.entities)

    def _emit(self, entities: Sequence[Action]) -> None:
        for each in entities:
            event = each.event
            for action in self.of("LifecycleNode"):
                if event.lifecycle_node_matcher(action):
                    self.change(action, _TRANSITIONS[event.transition_id])


def launched(package: Path) -> Launch:
    """The launch file of an emitted package, executed."""
    text = (package / f"launch/{package.name}.launch.py").read_text()
    with pytest.MonkeyPatch.context() as patched:
        for name, module in modules().items():
            patched.setitem(sys.modules, name, module)
        space: dict[str, Any] = {}
        exec(compile(text, "launch.py", "exec"), space)
        return Launch(space["generate_launch_description"]())
