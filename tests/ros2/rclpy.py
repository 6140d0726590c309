"""The calls of rclpy that emitted nodes make, for tests without ROS 2.

The contract stands at each call: what rclpy documents of it (Humble to Jazzy), in words. A call
that is not here is none of the contract, and what a node may not do raises, with a reason. Time and
topics are those of `tests.ros2.world`. A node that no executor spins is spun by the world.
"""

from __future__ import annotations

import enum
import inspect
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from tests.ros2.messages import message_class

if TYPE_CHECKING:
    from tests.ros2.world import Process, World

SECOND = 10**9


class Reliability(enum.Enum):
    """Best effort may lose messages; a reliable subscription takes none of such a publisher."""

    RELIABLE = 1
    BEST_EFFORT = 2


class Durability(enum.Enum):
    """A transient local publisher keeps its last messages for those who subscribes later so."""

    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class History(enum.Enum):
    """Whether the last `depth` messages are kept, or all."""

    KEEP_LAST = 1
    KEEP_ALL = 2


class QoSProfile:
    """Quality of service; a whole number in its place is the depth, all else by default.

    rclpy: keyword arguments only; `KEEP_LAST` asks for a depth; reliable and volatile by default.
    """

    def __init__(
        self,
        *,
        depth: int,
        history: History = History.KEEP_LAST,
        reliability: Reliability = Reliability.RELIABLE,
        durability: Durability = Durability.VOLATILE,
    ) -> None:
        assert depth > 0
        self.depth, self.history = depth, history
        self.reliability, self.durability = reliability, durability

    @classmethod
    def of(cls, given: QoSProfile | int) -> QoSProfile:
        return cls(depth=given) if isinstance(given, int) else given

    def takes_from(self, publisher: QoSProfile) -> bool:
        """Whether a subscription gets what a publisher offers (ROS 2: QoS compatibilities)."""
        reliable = publisher.reliability is Reliability.RELIABLE
        kept = publisher.durability is Durability.TRANSIENT_LOCAL
        return (reliable or self.reliability is Reliability.BEST_EFFORT) and (
            kept or self.durability is Durability.VOLATILE
        )


SENSOR_DATA = QoSProfile(depth=5, reliability=Reliability.BEST_EFFORT)


class ClockType(enum.Enum):
    """ROS time is system time unless `use_sim_time`; steady time never jumps."""

    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class Time:
    """rclpy.time.Time: `nanoseconds`, and `to_msg` gives a builtin_interfaces/Time."""

    def __init__(self, nanoseconds: int) -> None:
        self.nanoseconds = nanoseconds

    def to_msg(self) -> Any:
        sec, nanosec = divmod(self.nanoseconds, SECOND)
        return message_class("builtin_interfaces/Time")(sec=sec, nanosec=nanosec)


class Duration:
    """rclpy.duration.Duration."""

    def __init__(self, *, seconds: float) -> None:
        self.seconds = seconds


class Clock:
    """rclpy.clock.Clock: with `use_sim_time` that of ROS time is 0 before the first /clock."""

    def __init__(self, *, clock_type: ClockType, world: World) -> None:
        self.clock_type, self._world = clock_type, world
        self.simulated: int | None = None
        """The last time on /clock."""

    def now(self) -> Time:
        if self.clock_type is ClockType.STEADY_TIME:
            return Time(self._world.steady)
        if self.simulated is not None:
            return Time(self.simulated)
        return Time(self._world.system)


class Spinning(Exception):  # noqa: N818
    """Raised by `rclpy.spin`: the node is set up, and the world spins it from here on."""


class ExternalShutdownException(Exception):  # noqa: N818 - rclpy's name
    """rclpy.executors: raised by an executor whose context was shut down."""


class InvalidParameterValueException(Exception):  # noqa: N818 - rclpy's name
    """rclpy.exceptions: a parameter's value is outside of its range."""


class Logger:
    """What a node logs, as pairs of level and text."""

    def __init__(self, lines: list[tuple[str, str]]) -> None:
        self._lines = lines

    def __getattr__(self, level: str) -> Callable[[str], None]:
        assert level in ("debug", "info", "warning", "error", "fatal"), level
        return lambda text: self._lines.append((level, text))


class Publisher:
    """rclpy.publisher.Publisher."""

    def __init__(self, node: Node, kind: type, topic: str, qos: QoSProfile) -> None:
        self.node, self.kind, self.topic, self.qos = node, kind, topic, qos
        self.kept: deque[Any] = deque(maxlen=qos.depth)
        self.acknowledged = True

    def publish(self, message: Any) -> None:
        """Send a message of the publisher's type; another one is a TypeError."""
        if not isinstance(message, self.kind):
            raise TypeError(f"expected {self.kind.__name__}, got {type(message).__name__}")
        assert self.node.process.is_running, "nothing is published after rclpy.shutdown()"
        self.acknowledged = False
        self.node.process.world.send(self, message)

    def wait_for_all_acked(self, timeout: Duration) -> bool:
        """Whether all subscribers have what was sent within that time; RCLError: nobody knows."""
        assert timeout.seconds > 0, "for ever, or no time at all"
        if not self.node.process.world.acknowledges:
            raise RuntimeError("the middleware does not support it")
        self.acknowledged = True
        return True


class LifecyclePublisher(Publisher):
    """rclpy.lifecycle: what it is to publish while its node is not active is dropped."""

    enabled = False

    def publish(self, message: Any) -> None:
        if self.enabled:
            super().publish(message)


@dataclass(eq=False)
class Subscription:
    """rclpy.subscription.Subscription: of more than `depth` messages that wait the oldest go."""

    node: Node
    kind: type
    topic_name: str
    callback: Callable[[Any], None]
    qos: QoSProfile

    def __post_init__(self) -> None:
        self.waiting: deque[Any] = deque(maxlen=self.qos.depth)

    def take(self) -> None:
        if self.waiting and self in self.node.subscriptions:
            self.callback(self.waiting.popleft())


@dataclass(eq=False)
class Timer:
    """rclpy.timer.Timer: calls again and again, at first after one period, until cancelled."""

    node: Node
    period: int
    callback: Callable[[], None]

    def ring(self) -> None:
        if self in self.node.timers:
            self.node.process.world.after(self.period, self.node, self.ring)
            self.callback()


class Parameter:
    """rclpy.parameter.Parameter: its `value`."""

    def __init__(self, value: Any) -> None:
        self.value = value


class Node:
    """rclpy.node.Node."""

    process: Process

    def __init__(self, node_name: str) -> None:
        assert self.process.is_running, "rclpy.init() comes before a node"
        self.name = self.process.remapped("__node", node_name)
        self.publishers: list[Publisher] = []
        self.subscriptions: list[Subscription] = []
        self.timers: list[Timer] = []
        self.parameters: dict[str, Any] = {}
        self.descriptors: dict[str, Any] = {}
        self.log: list[tuple[str, str]] = []
        self._clock = Clock(clock_type=ClockType.ROS_TIME, world=self.process.world)
        self.process.nodes.append(self)
        self.declare_parameter("use_sim_time", False)
        if self.parameters["use_sim_time"]:
            self._clock.simulated = 0
            clock = message_class("rosgraph_msgs/Clock")
            self.create_subscription(clock, "/clock", self._clock_message, SENSOR_DATA)

    def _clock_message(self, message: Any) -> None:
        self._clock.simulated = message.clock.sec * SECOND + message.clock.nanosec

    def get_name(self) -> str:
        return self.name

    def get_logger(self) -> Logger:
        return Logger(self.log)

    def get_clock(self) -> Clock:
        """The clock of ROS time."""
        return self._clock

    def declare_parameter(
        self, name: str, value: Any, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """A parameter with its default; an override from the command line comes first.

        rclpy: raises InvalidParameterValueException for a value outside of the descriptor's range
        and InvalidParameterTypeException for one of another type than the default's. A read-only
        parameter can be overridden still, unless overrides are ignored.
        """
        assert name not in self.parameters, f"{name} is declared twice"
        if not ignore_override:
            given = self.process.parameters.get(name, value)
            assert type(given) is type(value), f"InvalidParameterTypeException: {name}"
            value = given
        for bounds in getattr(descriptor, "floating_point_range", ()):
            if not bounds.from_value <= value <= bounds.to_value:
                raise InvalidParameterValueException(f"{name}: {value} is out of range")
        self.parameters[name], self.descriptors[name] = value, descriptor
        return Parameter(value)

    def get_parameter(self, name: str) -> Parameter:
        return Parameter(self.parameters[name])

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any) -> Publisher:
        """A publisher; relative names are below the node's namespace, `~/` below its name."""
        return self._publisher(Publisher, msg_type, topic, qos_profile)  # type: ignore[no-any-return]

    def _publisher(
        self, kind: type[Publisher], msg_type: type, topic: str, qos: QoSProfile | int
    ) -> Any:
        publisher = kind(self, msg_type, self._resolved(topic), QoSProfile.of(qos))
        self.publishers.append(publisher)
        return publisher

    def _resolved(self, topic: str) -> str:
        full = topic.replace("~", f"/{self.name}", 1) if topic.startswith("~") else topic
        full = full if full.startswith("/") else f"/{full}"
        return self.process.remapped(topic, self.process.remapped(full, full))

    def create_subscription(
        self, msg_type: type, topic: str, callback: Callable[[Any], None], qos_profile: Any
    ) -> Subscription:
        """Call back for each message; one of a transient local publisher for what it keeps, too.

        The latter only where the subscription is transient local itself.
        """
        assert len(inspect.signature(callback).parameters) == 1, "a callback takes one message"
        qos = QoSProfile.of(qos_profile)
        subscription = Subscription(self, msg_type, self._resolved(topic), callback, qos)
        self.subscriptions.append(subscription)
        self.process.world.join(subscription)
        return subscription

    def create_timer(
        self, timer_period_sec: float, callback: Callable[[], None], clock: Clock | None = None
    ) -> Timer:
        """Call back each period, on the node's clock (ROS time) unless one is given."""
        assert clock is not None, "a timer of ROS time stands still with it: give a clock"
        assert clock.clock_type is ClockType.STEADY_TIME
        timer = Timer(self, round(timer_period_sec * SECOND), callback)
        self.timers.append(timer)
        self.process.world.after(timer.period, self, timer.ring)
        return timer

    def destroy_timer(self, timer: Timer) -> bool:
        self.timers.remove(timer)
        return True

    def destroy_subscription(self, subscription: Subscription) -> bool:
        self.subscriptions.remove(subscription)
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """It sends nothing again: what nobody has acknowledged may be lost."""
        kept = publisher.qos.durability is Durability.TRANSIENT_LOCAL
        if kept and self.process.world.acknowledges:
            assert publisher.acknowledged, f"the last message on {publisher.topic} may be lost"
        self.publishers.remove(publisher)
        return True

    def count_publishers(self, topic_name: str) -> int:
        """How many publishers of a topic the graph knows of."""
        return len([each for each in self.process.world.publishers if each.topic == topic_name])

    def get_publishers_info_by_topic(self, topic_name: str) -> list[Any]:
        """The publishers of a topic; the name is not remapped."""
        return [
            _endpoint(each, each.topic)
            for each in self.process.world.publishers
            if each.topic == topic_name
        ]

    def get_subscriptions_info_by_topic(self, topic_name: str) -> list[Any]:
        """The subscriptions of a topic; the name is not remapped."""
        return [
            _endpoint(each, each.topic_name)
            for each in self.process.world.subscriptions
            if each.topic_name == topic_name
        ]

    def get_fully_qualified_name(self) -> str:
        return f"/{self.name}"

    def destroy_node(self) -> None:
        """All that the node has created is gone; it is not called back any more."""
        self.publishers, self.subscriptions, self.timers = [], [], []
        if self in self.process.nodes:
            self.process.nodes.remove(self)


def _endpoint(each: Publisher | Subscription, topic: str) -> Any:
    """rclpy.topic_endpoint_info.TopicEndpointInfo: the hash is there since Iron."""
    return SimpleNamespace(
        node_name=each.node.name,
        node_namespace="/",
        topic_type=each.kind.__name__,
        topic_type_hash=each.node.process.world.hashes.get(topic, "RIHS01_00")
        if isinstance(each, Publisher)
        else "RIHS01_00",
    )


class Return(enum.Enum):
    """rclpy.lifecycle.TransitionCallbackReturn."""

    SUCCESS = 1
    FAILURE = 2
    ERROR = 3


class LifecycleNode(Node):
    """rclpy.lifecycle.LifecycleNode, after the design of managed nodes.

    It begins unconfigured. The transitions are a service, `World.change`. A callback that raises
    counts as ERROR, and `on_error` decides: SUCCESS leaves the node unconfigured, anything else
    finalized. The callbacks of the base class enable (activate) and disable (deactivate) the
    lifecycle publishers.
    """

    def __init__(self, node_name: str) -> None:
        super().__init__(node_name)
        self.state = "unconfigured"

    def create_lifecycle_publisher(self, msg_type: type, topic: str, qos_profile: Any) -> Publisher:
        """A publisher that drops what comes while the node is not active."""
        return self._publisher(LifecyclePublisher, msg_type, topic, qos_profile)  # type: ignore[no-any-return]

    def destroy_lifecycle_publisher(self, publisher: Publisher) -> bool:
        return self.destroy_publisher(publisher)

    def on_configure(self, state: Any) -> Return:
        return Return.SUCCESS

    def on_activate(self, state: Any) -> Return:
        return self._enable(True)

    def on_deactivate(self, state: Any) -> Return:
        return self._enable(False)

    def on_cleanup(self, state: Any) -> Return:
        return self._enable(False)

    def on_shutdown(self, state: Any) -> Return:
        return self._enable(False)

    def on_error(self, state: Any) -> Return:
        return Return.SUCCESS

    def _enable(self, enabled: bool) -> Return:
        for publisher in self.publishers:
            if isinstance(publisher, LifecyclePublisher):
                publisher.enabled = enabled
        return Return.SUCCESS

    def __getattr__(self, name: str) -> Callable[[], Return]:
        """`trigger_configure()` and so on: the same transitions, as calls of the node itself."""
        transition = name.removeprefix("trigger_")
        if name == transition or transition not in {each for _, each in _TRANSITIONS}:
            raise AttributeError(name)
        return lambda: Return.SUCCESS if self.change(transition) else Return.FAILURE

    def change(self, transition: str) -> bool:
        """What the service `change_state` answers; False, too, where it leads nowhere."""
        found = _TRANSITIONS.get((self.state, transition))
        if found is None:
            return False
        callback, goal = found
        try:
            result = callback(self)(SimpleNamespace(label=self.state))
        except Exception:
            result = Return.ERROR
        if result is Return.ERROR:
            fixed = self.on_error(SimpleNamespace(label=self.state)) is Return.SUCCESS
            self.state = "unconfigured" if fixed else "finalized"
        elif result is Return.SUCCESS:
            self.state = goal
        return result is Return.SUCCESS


_TRANSITIONS: Mapping[tuple[str, str], tuple[Callable[[LifecycleNode], Any], str]] = {
    ("unconfigured", "configure"): (lambda node: node.on_configure, "inactive"),
    ("inactive", "activate"): (lambda node: node.on_activate, "active"),
    ("active", "deactivate"): (lambda node: node.on_deactivate, "inactive"),
    ("inactive", "cleanup"): (lambda node: node.on_cleanup, "unconfigured"),
    ("unconfigured", "shutdown"): (lambda node: node.on_shutdown, "finalized"),
    ("inactive", "shutdown"): (lambda node: node.on_shutdown, "finalized"),
    ("active", "shutdown"): (lambda node: node.on_shutdown, "finalized"),
}


class Executor:
    """rclpy.executors.SingleThreadedExecutor."""

    def __init__(self, process: Process) -> None:
        self._process = process

    def add_node(self, node: Node) -> bool:
        assert node.process is self._process
        return True

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback at most so long, and make it.

        rclpy: what a callback raises comes out of it; ExternalShutdownException where the context
        was shut down. Here the time passes in which the world waits.
        """
        assert timeout_sec is not None
        self._process.world.wait(round(timeout_sec * SECOND), self._process)
        if not self._process.is_running:
            raise ExternalShutdownException

    def shutdown(self) -> bool:
        return True
