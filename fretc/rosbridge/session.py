"""The operations of one client of the endpoint.

Deviations from rosbridge: there are no actions, clients advertise no services, and calls are
answered one after the other, without a check of their type. PNG compression and `cbor-raw` are
refused. Without a check of types, each published message is taken as it is.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from fretc.rosbridge.subscriptions import Subscription, TopicQueue

MOST_TOPICS = 256
"""Topics that one client may advertise, and topics to which it may subscribe."""
MOST_SUBSCRIPTIONS = 16
"""Subscriptions of a client to one topic."""
_LEVELS = ("none", "error", "warning", "info")
_LONGEST = 256


Service = Callable[[Mapping[str, Any]], "Mapping[str, Any] | None"]
"""The request of a call → the fields of its answer; None: it is never answered. A ValueError says
why the call fails."""
NO_SERVICES: Mapping[str, Service] = MappingProxyType({})


class RefusedError(Exception):
    """An operation is refused; the text says why."""

    def __init__(self, text: str, level: str = "error") -> None:
        super().__init__(text)
        self.level = level


class Graph:
    """The topics of the endpoint with their types."""

    def __init__(
        self,
        types: Mapping[str, str],
        publish: Callable[[str, str, Any], None],
        services: Mapping[str, Service] = NO_SERVICES,
    ) -> None:
        """The topics before any client.

        Args:
            types: of the topics that always exist.
            publish: takes topic, type and message of a client.
            services: name → what answers.
        """
        self.services = services
        self._own = frozenset(types)
        self.types = dict(types)
        self.publish = publish
        self.sessions: set[Session] = set()

    def establish(self, topic: str, kind: str) -> None:
        """Give a topic its type.

        Raises:
            RefusedError: it has another type.
        """
        known = self.types.setdefault(topic, kind)
        if known != kind:
            raise RefusedError(f"{topic} has the type {known}, not {kind}")

    def release(self, *topics: str) -> None:
        """Forget those of the topics that nobody uses any more."""
        for topic in topics:
            if topic not in self._own and not any(s.uses(topic) for s in self.sessions):
                self.types.pop(topic, None)


class Session:
    """One client: its advertisements and its subscriptions."""

    def __init__(self, graph: Graph, reply: Callable[[dict[str, Any]], None]) -> None:
        """`reply` sends an operation to the client."""
        self._graph, self._reply = graph, reply
        self._advertised: set[str] = set()
        self._level = 1
        graph.sessions.add(self)
        self.queues: dict[str, TopicQueue] = {}
        self._operations: Mapping[str, Callable[[Mapping[str, Any]], None]] = {
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            "publish": self._publish,
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "call_service": self._call,
            "set_level": self._set_level,
            "status": lambda operation: None,
        }

    def uses(self, topic: str) -> bool:
        """Whether the client has advertised the topic, or subscribed to it."""
        return topic in self._advertised or topic in self.queues

    def close(self) -> None:
        """End all advertisements and subscriptions."""
        self._graph.sessions.discard(self)
        self._graph.release(*self._advertised, *self.queues)

    def receive(self, text: str | bytes) -> None:
        """Do what a client's message asks for; a mistake is answered by a status."""
        id = None
        try:
            operation = _read(text)
            id = operation.get("id")
            name = operation.get("op")
            perform = self._operations.get(name) if isinstance(name, str) else None
            if perform is None:
                raise RefusedError(f"unknown operation {_shortened(name)}")
            perform(operation)
        except RefusedError as error:
            if _LEVELS.index(error.level) <= self._level:
                status = {"op": "status", "level": error.level, "msg": str(error)}
                self._reply(status if id is None else {**status, "id": id})

    def _advertise(self, operation: Mapping[str, Any]) -> None:
        topic, kind = _topic(operation), _type(operation)
        if kind is None:
            raise RefusedError("advertise needs a type")
        if len(self._advertised | {topic}) > MOST_TOPICS:
            raise RefusedError(f"a client advertises at most {MOST_TOPICS} topics")
        self._graph.establish(topic, kind)
        self._advertised.add(topic)

    def _unadvertise(self, operation: Mapping[str, Any]) -> None:
        topic = _topic(operation)
        if topic not in self._advertised:
            raise RefusedError(f"{topic} is not advertised", "warning")
        self._advertised.remove(topic)
        self._graph.release(topic)

    def _publish(self, operation: Mapping[str, Any]) -> None:
        topic = _topic(operation)
        if topic not in self._advertised:
            raise RefusedError(f"{topic} is not advertised")
        message = operation.get("msg")
        if not isinstance(message, dict):
            raise RefusedError("publish needs a message")
        try:
            self._graph.publish(topic, self._graph.types[topic], message)
        except ValueError as error:
            raise RefusedError(f"the message does not conform: {error}") from error

    def _subscribe(self, operation: Mapping[str, Any]) -> None:
        topic, kind = _topic(operation), _type(operation)
        if kind is None and topic not in self._graph.types:
            raise RefusedError(f"{topic} does not exist, and its type is unknown")
        throttle, queue = _whole(operation, "throttle_rate"), _whole(operation, "queue_length")
        fragment = operation.get("fragment_size")
        if fragment is not None:
            fragment = max(1, _whole(operation, "fragment_size"))
        compression = operation.get("compression", "none")
        if compression not in ("none", "cbor"):
            raise RefusedError(f"compression {_shortened(compression)} is not supported")
        if topic not in self.queues and len(self.queues) >= MOST_TOPICS:
            raise RefusedError(f"a client subscribes to at most {MOST_TOPICS} topics")
        own = self.queues[topic].subscriptions if topic in self.queues else {}
        id = str(operation.get("id", ""))
        if id not in own and len(own) >= MOST_SUBSCRIPTIONS:
            raise RefusedError(f"a topic has at most {MOST_SUBSCRIPTIONS} subscriptions")
        self._graph.establish(topic, kind or self._graph.types[topic])
        own = self.queues.setdefault(topic, TopicQueue()).subscriptions
        own[id] = Subscription(throttle / 1000, queue, fragment, compression)

    def _unsubscribe(self, operation: Mapping[str, Any]) -> None:
        topic = _topic(operation)
        if topic not in self.queues:
            raise RefusedError(f"there is no subscription to {topic}", "warning")
        own = self.queues[topic].subscriptions
        if "id" not in operation:
            own.clear()
        elif own.pop(str(operation["id"]), None) is None:
            raise RefusedError("there is no subscription with this id", "warning")
        if not own:
            del self.queues[topic]
            self._graph.release(topic)

    def _call(self, operation: Mapping[str, Any]) -> None:
        service = operation.get("service")
        if not isinstance(service, str):
            raise RefusedError("call_service needs a service")
        answer: dict[str, Any] = {"op": "service_response", "service": service}
        if "id" in operation:
            answer["id"] = operation["id"]
        perform = self._graph.services.get(service if service.startswith("/") else f"/{service}")
        arguments = operation.get("args", {})
        try:
            if perform is None:
                raise ValueError(f"service {_shortened(service)} does not exist")
            if not isinstance(arguments, dict):
                raise ValueError("the arguments of a call are an object")
            values = perform(arguments)
        except ValueError as error:
            self._reply({**answer, "values": str(error), "result": False})
            return
        if values is not None:
            self._reply({**answer, "values": dict(values), "result": True})

    def _set_level(self, operation: Mapping[str, Any]) -> None:
        level = operation.get("level")
        if level not in _LEVELS:
            raise RefusedError(f"unknown level {_shortened(level)}")
        self._level = _LEVELS.index(level)


def _read(text: str | bytes) -> Mapping[str, Any]:
    if isinstance(text, bytes):
        raise RefusedError("operations are JSON texts")
    try:
        operation = json.loads(text)
    except (ValueError, RecursionError):
        raise RefusedError("the operation is no JSON") from None
    if not isinstance(operation, dict):
        raise RefusedError("the operation is no JSON object")
    id = operation.get("id", "")
    if not isinstance(id, str | int) or len(str(id)) > _LONGEST:
        raise RefusedError("an id is a short text or a whole number")
    return operation


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _topic(operation: Mapping[str, Any]) -> str:
    topic = operation.get("topic")
    if not isinstance(topic, str) or not 0 < len(topic) <= _LONGEST:
        raise RefusedError("the operation needs a topic")
    return topic if topic.startswith("/") else f"/{topic}"


def _type(operation: Mapping[str, Any]) -> str | None:
    """The type as in ROS 1, without `msg`."""
    kind = operation.get("type")
    if kind is None:
        return None
    if not isinstance(kind, str) or not 0 < len(kind) <= _LONGEST:
        raise RefusedError("a type is a short text")
    return kind.replace("/msg/", "/")


def _whole(operation: Mapping[str, Any], name: str) -> int:
    value = operation.get(name, 0)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= 10**6:
        raise RefusedError(f"{name} is a whole number, at most a million")
    return value
