"""Processes of ROS 2 for tests: topics between them, and a clock of their own.

Time passes only where a test lets it (`World.run`), or a node that spins. What is due at one time
happens in the order in which it was asked for, so that a run is the same each time. A `Process`
stands for one of the operating system: modules that it loads see a `rclpy` of their own, and it can
be killed.
"""

from __future__ import annotations

import heapq
import importlib
import itertools
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from tests.ros2 import rclpy
from tests.ros2.messages import Messages

SYSTEM_START = 1_700_000_000 * rclpy.SECOND
"""System time when a world begins."""
PACKAGES = (
    "builtin_interfaces diagnostic_msgs geometry_msgs nav_msgs rcl_interfaces rosgraph_msgs "
    "sensor_msgs std_msgs lifecycle_msgs action_msgs tf2_msgs"
).split()


class Process:
    """One process: its arguments, its `rclpy`, its nodes."""

    def __init__(self, world: World, arguments: Sequence[str]) -> None:
        self.world, self.arguments = world, tuple(arguments)
        self.is_running = False
        self.nodes: list[rclpy.Node] = []
        self.parameters: dict[str, Any] = {}
        self._remaps: dict[str, str] = {}
        self.modules = _modules(self)

    def init(self, args: object = None, signal_handler_options: object = None) -> None:
        """rclpy.init: reads ROS arguments: `-p name:=value`, `-r from:=to`.

        Raises:
            RuntimeError: it was called before.
        """
        if self.is_running:
            raise RuntimeError("Context.init() must only be called once")
        for flag, word in itertools.pairwise(self.arguments):
            name, _, value = word.partition(":=")
            if flag == "-p":
                self.parameters[name] = _read(value)
            elif flag == "-r":
                self._remaps[name] = value
        self.is_running = True

    def remapped(self, name: str, otherwise: str) -> str:
        return self._remaps.get(name, otherwise)

    def shutdown(self) -> None:
        """rclpy.shutdown: raises where the context is shut down already."""
        if not self.is_running:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        self.is_running = False

    def spin(self, node: rclpy.Node) -> None:
        raise rclpy.Spinning

    def kill(self) -> None:
        """As SIGKILL does: nothing is said any more, and the graph finds out."""
        for node in list(self.nodes):
            node.destroy_node()
        self.is_running = False

    @contextmanager
    def imports(self) -> Iterator[None]:
        """What is imported meanwhile sees this process."""
        with pytest.MonkeyPatch.context() as patched:
            for name, module in self.modules.items():
                patched.setitem(sys.modules, name, module)
            yield

    @contextmanager
    def importing(self, package: Path) -> Iterator[None]:
        """The same, and the modules of an emitted Python package; no trace of these is left."""
        with self.imports(), pytest.MonkeyPatch.context() as patched:
            patched.syspath_prepend(str(package))
            _forget(package.name)
            try:
                yield
            finally:
                _forget(package.name)

    def load(self, package: Path, module: str) -> Any:
        """A module of an emitted Python package, with whatever it imports of its package."""
        with self.importing(package):
            return importlib.import_module(f"{package.name}.{module}")

    def spun(self, run: Callable[[], object]) -> None:
        """Call what spins: the node is set up, and the world spins it."""
        with self.imports(), suppress(rclpy.Spinning):
            run()


def _forget(package: str) -> None:
    for name in [each for each in sys.modules if each.partition(".")[0] == package]:
        del sys.modules[name]


def _read(text: str) -> Any:
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


@dataclass(order=True)
class _Due:
    time: int
    rank: int
    node: Any = field(compare=False)
    action: Callable[[], None] = field(compare=False)


class World:
    """Processes, topics between them, and the time."""

    def __init__(self, start: int = SYSTEM_START) -> None:
        """Nothing is there yet; the system time at the start is given."""
        self.steady, self._start = 0, start
        self.acknowledges = True
        """Whether the middleware knows what subscribers have got (Zenoh and some others do not)."""
        self.hashes: dict[str, str] = {}
        """Topics whose publishers have another definition of their type, with its hash."""
        self.processes: list[Process] = []
        self.sent: dict[str, list[tuple[int, Any]]] = defaultdict(list)
        """Of each topic all messages, each with the steady time of its publication."""
        self._due: list[_Due] = []
        self._rank = itertools.count()

    @property
    def system(self) -> int:
        return self._start + self.steady

    def process(self, *arguments: str) -> Process:
        process = Process(self, arguments)
        self.processes.append(process)
        return process

    def node(self, name: str) -> rclpy.Node:
        """One of the test's own, in a process of its own."""
        process = self.process()
        process.init()
        node: rclpy.Node = process.modules["rclpy"].create_node(name)
        return node

    # Topics

    @property
    def publishers(self) -> list[rclpy.Publisher]:
        return [p for each in self.processes for node in each.nodes for p in node.publishers]

    @property
    def subscriptions(self) -> list[rclpy.Subscription]:
        return [s for each in self.processes for node in each.nodes for s in node.subscriptions]

    def send(self, publisher: rclpy.Publisher, message: Any) -> None:
        self.sent[publisher.topic].append((self.steady, message))
        publisher.kept.append(message)
        for subscription in self.subscriptions:
            if self._matches(publisher, subscription):
                self._deliver(subscription, message)

    def _matches(self, publisher: rclpy.Publisher, subscription: rclpy.Subscription) -> bool:
        return (
            publisher.topic == subscription.topic_name
            and publisher.kind is subscription.kind
            and subscription.qos.takes_from(publisher.qos)
        )

    def _deliver(self, subscription: rclpy.Subscription, message: Any) -> None:
        subscription.waiting.append(message)
        self.after(0, subscription.node, subscription.take)

    def join(self, subscription: rclpy.Subscription) -> None:
        if subscription.qos.durability is rclpy.Durability.TRANSIENT_LOCAL:
            for publisher in self.publishers:
                if self._matches(publisher, subscription):
                    for message in publisher.kept:
                        self._deliver(subscription, message)

    # Time

    def after(self, delay: int, node: rclpy.Node | None, action: Callable[[], None]) -> None:
        """Do something later, nanoseconds; of a node only while it is there."""
        heapq.heappush(self._due, _Due(self.steady + delay, next(self._rank), node, action))

    def run(self, seconds: float) -> None:
        """Let so much time pass."""
        end = self.steady + round(seconds * rclpy.SECOND)
        while self._due and self._due[0].time <= end:
            self._next()
        self.steady = end

    def wait(self, most: int, process: Process) -> None:
        """Let so many nanoseconds pass, or less: until a node of the process was called back."""
        end = self.steady + most
        while process.is_running and self._due and self._due[0].time <= end:
            if self._next() in process.nodes:
                return
        self.steady = end

    def _next(self) -> rclpy.Node | None:
        due = heapq.heappop(self._due)
        self.steady = due.time
        if due.node is None or due.node in due.node.process.nodes:
            due.action()
        node: rclpy.Node | None = due.node
        return node

    def values(self, topic: str, path: str = "data") -> list[Any]:
        """A field of all messages of a topic."""
        found = []
        for _, message in self.sent[topic]:
            for name in path.split("."):
                message = getattr(message, name)
            found.append(message)
        return found


def _modules(process: Process) -> dict[str, ModuleType]:
    node = type("Node", (rclpy.Node,), {"process": process})
    lifecycle_node = type("LifecycleNode", (rclpy.LifecycleNode,), {"process": process})
    steady = lambda clock_type: rclpy.Clock(clock_type=clock_type, world=process.world)  # noqa: E731
    contents: dict[str, dict[str, Any]] = {
        "rclpy": {
            "init": process.init,
            "ok": lambda: process.is_running,
            "shutdown": process.shutdown,
            "spin": process.spin,
            "spin_once": lambda node, timeout_sec: rclpy.Executor(process).spin_once(timeout_sec),
            "create_node": node,
        },
        "rclpy.clock": {
            "Clock": steady,
            "ClockType": rclpy.ClockType,
        },
        "rclpy.duration": {"Duration": rclpy.Duration},
        "rclpy.exceptions": {
            "InvalidParameterValueException": rclpy.InvalidParameterValueException
        },
        "rclpy.executors": {
            "SingleThreadedExecutor": lambda: rclpy.Executor(process),
            "ExternalShutdownException": rclpy.ExternalShutdownException,
        },
        "rclpy.lifecycle": {
            "LifecycleNode": lifecycle_node,
            "LifecycleState": SimpleNamespace,
            "TransitionCallbackReturn": rclpy.Return,
        },
        "rclpy.node": {"Node": node},
        "rclpy.qos": {
            "QoSProfile": rclpy.QoSProfile,
            "ReliabilityPolicy": rclpy.Reliability,
            "DurabilityPolicy": rclpy.Durability,
            "HistoryPolicy": rclpy.History,
            "qos_profile_sensor_data": rclpy.SENSOR_DATA,
        },
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO=0)},
    }
    modules: dict[str, ModuleType] = {}
    for name, content in contents.items():
        modules[name] = ModuleType(name)
        vars(modules[name]).update(content)
    for name in PACKAGES:
        modules[name], modules[f"{name}.msg"] = ModuleType(name), Messages(f"{name}.msg")
        vars(modules[name])["msg"] = modules[f"{name}.msg"]
    return modules
