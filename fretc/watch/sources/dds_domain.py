"""A domain of DDS, joined through Cyclone DDS: who publishes in it, and payloads in and out.

Payloads are CDR as it is on the wire, with its head of four bytes. Topics and types are named as
in ROS 2.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fretc.logs.messages.ros2_types import definitions
from fretc.watch.sources.dds_types import (
    Offer,
    UnreadableError,
    dds_topic,
    is_type,
    offered,
    payloads_of,
    ros_topic,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import install

_HIGHEST = 232
"""Of the numbers of domains: a higher one has no ports."""
_SPEAKS = 7
"""What Cyclone DDS prints by itself: fatal errors, errors and warnings."""
_AT_ONCE = 500
"""Samples that are taken by one call."""


@dataclass(frozen=True, slots=True)
class Publisher:
    """A publisher that is there or, without an offer, that is there no more."""

    handle: int
    """What its messages name it by."""
    id: str
    """Stays the same when it is lost and found again."""
    topic: str
    offer: Offer | None


@dataclass(frozen=True, slots=True)
class Sample:
    """A message."""

    payload: bytes
    publisher: int
    """A handle."""
    sent: int | None
    """Nanoseconds, by the clock of the publisher; None: it does not say."""


def domain_id() -> int | Diagnostic:
    """The domain that `ROS_DOMAIN_ID` names, 0 where it names none."""
    text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    if text.isascii() and text.isdigit() and len(text) < 9 and int(text) <= _HIGHEST:
        return int(text)
    return Diagnostic(
        Code.ROBOT_NOT_REACHED,
        f"ROS_DOMAIN_ID is `{text[:40]}`, which is not a number from 0 to {_HIGHEST}",
        help="set it to the domain of the robot, or unset it",
    )


def join() -> Domain | Diagnostic:
    """A part of the domain that `ROS_DOMAIN_ID` names, as `CYCLONEDDS_URI` configures it."""
    try:
        import cyclonedds.domain  # noqa: F401

        definitions("std_msgs/msg/Header")
    except Exception as error:  # beside the absent package, its C library may not be found
        return Diagnostic(
            Code.MISSING_EXTRA,
            f"watching DDS needs Cyclone DDS, which is not installed: {error}",
            help=install("live"),
        )
    number = domain_id()
    return number if isinstance(number, Diagnostic) else _joined(number)


def _joined(number: int) -> Domain | Diagnostic:
    from cyclonedds.core import DDSException
    from cyclonedds.internal import DDS

    library: Any = DDS._dll_handle
    library.dds_set_log_mask(_SPEAKS)
    try:
        domain = Domain(number)
    except DDSException:
        return Diagnostic(
            Code.ROBOT_NOT_REACHED,
            f"DDS domain {number} cannot be joined",
            help="Cyclone DDS has printed why: no network, or a mistake in CYCLONEDDS_URI",
        )
    library.dds_set_log_mask(0)  # from here on it speaks of packets of others, without end
    return domain


class Domain:
    """A participant of a domain, with nothing that is read or written yet."""

    def __init__(self, number: int) -> None:
        """Join it.

        Raises:
            DDSException: of Cyclone DDS; there is no network, or its configuration is wrong.
        """
        from cyclonedds import builtin
        from cyclonedds.core import WaitSet
        from cyclonedds.domain import DomainParticipant

        self.number = number
        self._participant = DomainParticipant(number)
        self._news = builtin.BuiltinDataReader(
            self._participant, builtin.BuiltinTopicDcpsPublication
        )
        self._wake = WaitSet(self._participant)
        self._attach(self._news)
        self._open: list[Reader | Writer] = []
        self._types: dict[tuple[str, str | None], Any] = {}
        self._topics: dict[tuple[str, tuple[str, str | None]], Any] = {}

    def _attach(self, reader: Any) -> None:
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        anything = SampleState.Any | ViewState.Any | InstanceState.Any
        self._wake.attach(ReadCondition(reader, anything))

    def close(self) -> None:
        """Leave it; nothing of it may be used any more."""
        for each in self._open:
            del each.entity
        self._topics.clear()
        del self._wake, self._news, self._participant

    def wait(self, seconds: float) -> None:
        """Until something has come, or for so long."""
        self._wake.wait(int(seconds * 1e9))

    def publishers(self) -> Iterator[Publisher]:
        """Who has come, changed, or gone since the last call; this process among them."""
        for _ in range(_AT_ONCE):
            try:
                found = self._news.take()
            except Exception:  # names of others may be no text, and each is one of its own
                continue
            if not found:
                return
            handle, id = found[0].sample_info.instance_handle, str(found[0].key)
            if not found[0].sample_info.valid_data:
                yield Publisher(handle, id, "", None)
            elif (topic := ros_topic(found[0].topic_name)) is not None:
                yield Publisher(handle, id, topic, offered(found[0]))

    def reader(self, topic: str, offer: Offer, definition: str | None) -> Reader:
        """What reads the messages of publishers with such an offer, and of others that match.

        Args:
            topic: `/scan`.
            offer: of a publisher.
            definition: of the type; None: it is not known.

        Raises:
            UnreadableError: the publisher has type information, and there is no definition that
                could be compared with it; or the name of its type is none.
        """
        from cyclonedds.core import DDSException

        if not is_type(offer.type):
            raise UnreadableError("its type has no name")
        if offer.described and definition is None:
            raise UnreadableError("its type is not a type of ROS 2")
        try:
            reader = Reader(self._participant, self._topic(topic, offer, definition), offer)
        except DDSException as error:
            raise UnreadableError(str(error)) from None
        self._attach(reader.entity)
        self._open.append(reader)
        return reader

    def _topic(self, name: str, offer: Offer, definition: str | None) -> Any:
        """One for each type: Cyclone DDS does not come back where equal types are several."""
        from cyclonedds.topic import Topic

        type_ = offer.type, definition if offer.described else None
        if type_ not in self._types:
            self._types[type_] = payloads_of(*type_)
        if (name, type_) not in self._topics:
            topic: Any = Topic(self._participant, dds_topic(name), self._types[type_])
            self._topics[name, type_] = topic
        return self._topics[name, type_]

    def writer(self, topic: str, offer: Offer, definition: str) -> Writer:
        """What publishes messages, so that ROS 2 and every reader with type information reads them.

        Args:
            topic: `/diagnostics`.
            offer: what is said of them.
            definition: of the type.

        Raises:
            UnreadableError: it cannot be written.
        """
        from cyclonedds.core import DDSException

        try:
            writer = Writer(self._participant, self._topic(topic, offer, definition), offer)
        except DDSException as error:
            raise UnreadableError(str(error)) from None
        self._open.append(writer)
        return writer


class Reader:
    """Reads a topic, and takes what comes from anybody who matches.

    What was lost on the wire is not known: Cyclone DDS does not count it as a lost sample.
    """

    def __init__(self, participant: Any, topic: Any, offer: Offer) -> None:
        from cyclonedds.qos import Policy
        from cyclonedds.sub import DataReader

        policies = [
            *_policies(offer),
            Policy.History.KeepAll,
            Policy.ResourceLimits(-1, -1, -1),
            Policy.TypeConsistency.AllowTypeCoercion(ignore_member_names=True),
        ]
        self.entity: Any = DataReader(participant, topic, qos=_qos(policies))

    def samples(self) -> Iterator[Sample]:
        """All that have come since the last call."""
        while found := self.entity.take(N=_AT_ONCE):
            for each in found:
                info = each.sample_info
                if info.valid_data:
                    sent = info.source_timestamp
                    yield Sample(each.payload, info.publication_handle, sent if sent > 0 else None)

    def matches(self, handle: int) -> bool:
        """Whether messages of the publisher come through."""
        signed = ctypes.c_int64(handle).value
        return bool({handle, signed} & {*self.entity.get_matched_publications()})


class Writer:
    """Publishes on a topic."""

    def __init__(self, participant: Any, topic: Any, offer: Offer) -> None:
        from cyclonedds.pub import DataWriter
        from cyclonedds.qos import Policy

        policies = [*_policies(offer), Policy.History.KeepLast(1 if offer.keeps else 10)]
        if offer.hash is not None:
            policies.append(Policy.Userdata(f"typehash={offer.hash};".encode()))
        self.entity: Any = DataWriter(participant, topic, qos=_qos(policies))

    def write(self, payload: bytes, sent: int | None = None) -> None:
        """A message, as CDR with its head of four bytes; sent now, or at a time in nanoseconds.

        Raises:
            UnreadableError: it is no message of the type.
        """
        from cyclonedds.core import DDSException

        sample = self.entity.topic.data_type()
        sample.payload = payload
        try:
            self.entity.write(sample, sent)
        except DDSException as error:
            raise UnreadableError(str(error)) from None

    @property
    def readers(self) -> int:
        """How many read it."""
        return len(self.entity.get_matched_subscriptions())


def _policies(offer: Offer) -> list[Any]:
    from cyclonedds.qos import Policy

    return [
        Policy.Reliability.Reliable(100_000_000)
        if offer.reliable
        else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if offer.keeps else Policy.Durability.Volatile,
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    ]


def _qos(policies: list[Any]) -> Any:
    from cyclonedds.qos import Qos

    return Qos(*policies)
