"""A DDS domain, joined through Cyclone DDS: its publishers, readers and writers.

Payloads are CDR as sent, with a head of four bytes. Topics and types have their names in ROS 2.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from typing import Any

from fretc.logs.messages.ros2_types import definitions
from fretc.watch.sources.dds_types import (
    Offer,
    UnreadableTypeError,
    dds_topic,
    is_type,
    offered,
    payloads_of,
    ros_topic,
)
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.messages import diagnostic

_HIGHEST = 232
"""The largest domain number that has ports."""
_SPEAKS = 7
"""The categories of messages that Cyclone DDS prints by itself: fatal errors, errors and
warnings."""
_AT_ONCE = 500
"""The most samples of one call."""


@dataclass(frozen=True, slots=True)
class DdsPublisher:
    """A publisher; without an offer, it is gone."""

    handle: int
    """Its identifier in messages."""
    id: str
    """An identifier that does not change when the publisher is lost and found again."""
    topic: str
    offer: Offer | None
    participant: str = ""
    """The identifier of its participant, which begins with the number of the DDS vendor."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A message."""

    payload: bytes
    publisher: int
    """The handle of the publisher."""
    sent: int | None
    """The send time in nanoseconds, on the clock of the publisher; None: not stated."""


def domain_id() -> int | Diagnostic:
    """The number in `ROS_DOMAIN_ID`, or 0."""
    text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    if text.isascii() and text.isdigit() and len(text) < 9 and int(text) <= _HIGHEST:
        return int(text)
    return diagnostic("bad_domain_id", text=text[:40], highest=_HIGHEST)


def join() -> Domain | Diagnostic:
    """A participant of the domain in `ROS_DOMAIN_ID`, as `CYCLONEDDS_URI` configures it."""
    try:
        import cyclonedds.domain  # noqa: F401

        definitions("std_msgs/msg/Header")
    except Exception as error:  # the package or its C library is missing
        return diagnostic("no_cyclone_dds", error=error, extra=install_help("live"))
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
        return diagnostic("domain_not_joined", number=number)
    library.dds_set_log_mask(0)  # later messages would be about packets of others
    return domain


class Domain:
    """A participant of a domain, without readers or writers yet."""

    def __init__(self, number: int) -> None:
        """Join the domain.

        Raises:
            DDSException: from Cyclone DDS; there is no network, or the configuration is wrong.
        """
        from cyclonedds import builtin
        from cyclonedds.core import WaitSet
        from cyclonedds.domain import DomainParticipant

        self.number = number
        self._participant = DomainParticipant(number)
        self._news = builtin.BuiltinDataReader(
            self._participant, builtin.BuiltinTopicDcpsPublication
        )
        self._others = builtin.BuiltinDataReader(
            self._participant, builtin.BuiltinTopicDcpsSubscription
        )
        self._wake = WaitSet(self._participant)
        self._attach(self._news)
        self._open: list[Reader | DdsWriter] = []
        self._types: dict[tuple[str, str | None], Any] = {}
        self._topics: dict[tuple[str, tuple[str, str | None]], Any] = {}

    def _attach(self, reader: Any) -> None:
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState

        anything = SampleState.Any | ViewState.Any | InstanceState.Any
        self._wake.attach(ReadCondition(reader, anything))

    def close(self) -> None:
        """Leave the domain, which cannot be used any more."""
        for each in self._open:
            del each.entity
        self._topics.clear()
        del self._wake, self._news, self._others, self._participant

    def wait(self, seconds: float) -> None:
        """Wait until data arrives, or for so long."""
        self._wake.wait(int(seconds * 1e9))

    def publishers(self) -> Iterator[DdsPublisher]:
        """Publishers that appeared, changed, or disappeared since the last call."""
        for _ in range(_AT_ONCE):
            try:
                samples = self._news.take()
            except Exception:  # names of others may be invalid text; each is separate
                continue
            if not samples:
                return
            handle, id = samples[0].sample_info.instance_handle, str(samples[0].key)
            if not samples[0].sample_info.valid_data:
                yield DdsPublisher(handle, id, "", None)
            elif (topic := ros_topic(samples[0].topic_name)) is not None:
                participant = samples[0].participant_key.hex
                yield DdsPublisher(handle, id, topic, offered(samples[0]), participant)

    def readers_of_others(self) -> Iterator[tuple[str, str]]:
        """Participant and DDS topic of readers that appeared since the last call."""
        for _ in range(_AT_ONCE):
            try:
                samples = self._others.take()
            except Exception:  # as above
                continue
            if not samples:
                return
            if samples[0].sample_info.valid_data:
                yield samples[0].participant_key.hex, samples[0].topic_name

    def reader(self, topic: str, offer: Offer, definition: str | None) -> Reader:
        """A reader for messages of publishers with such an offer, and of others that match.

        Args:
            topic: `/scan`.
            offer: the offer of a publisher.
            definition: the definition of the type; None: unknown.

        Raises:
            UnreadableError: the publisher has type information, and no definition can be compared
                with it; or the name of its type is invalid.
        """
        from cyclonedds.core import DDSException

        if not is_type(offer.type):
            raise UnreadableTypeError("its type has no name")
        if offer.described and definition is None:
            raise UnreadableTypeError("its type is not a type of ROS 2")
        try:
            reader = Reader(self._participant, self._topic(topic, offer, definition), offer)
        except DDSException as error:
            raise UnreadableTypeError(str(error)) from None
        self._attach(reader.entity)
        self._open.append(reader)
        return reader

    def _topic(self, name: str, offer: Offer, definition: str | None) -> Any:
        """The topic for a type, cached because Cyclone DDS hangs on equal types."""
        from cyclonedds.topic import Topic

        type_ = offer.type, definition if offer.described else None
        if type_ not in self._types:
            self._types[type_] = payloads_of(*type_)
        if (name, type_) not in self._topics:
            topic: Any = Topic(self._participant, dds_topic(name), self._types[type_])
            self._topics[name, type_] = topic
        return self._topics[name, type_]

    def release(self, *entities: Reader | DdsWriter) -> None:
        """Delete readers and writers, which cannot be used any more."""
        for each in entities:
            self._open.remove(each)
            del each.entity

    def writer(self, topic: str, offer: Offer, definition: str | None) -> DdsWriter:
        """A writer whose messages ROS 2 and every reader with type information can read.

        Args:
            topic: `/diagnostics`.
            offer: the offer of the writer.
            definition: the definition of the type; None: unknown.

        Raises:
            UnreadableError: the type cannot be written.
        """
        from cyclonedds.core import DDSException

        try:
            writer = DdsWriter(self._participant, self._topic(topic, offer, definition), offer)
        except DDSException as error:
            raise UnreadableTypeError(str(error)) from None
        self._open.append(writer)
        return writer


class Reader:
    """A reader of a topic, for messages of all matching publishers.

    Messages lost on the network are not reported: Cyclone DDS does not count them as lost samples.
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
        """All messages since the last call."""
        while samples_of_entity := self.entity.take(N=_AT_ONCE):
            for each in samples_of_entity:
                info = each.sample_info
                if info.valid_data:
                    sent = info.source_timestamp
                    yield Sample(each.payload, info.publication_handle, sent if sent > 0 else None)

    @property
    def publishers(self) -> int:
        """The number of publishers from which it receives messages."""
        return len(self.entity.get_matched_publications())

    def matches(self, handle: int) -> bool:
        """Whether the reader receives messages of the publisher."""
        signed = ctypes.c_int64(handle).value
        return bool({handle, signed} & {*self.entity.get_matched_publications()})


class DdsWriter:
    """A writer of messages of a topic."""

    def __init__(self, participant: Any, topic: Any, offer: Offer) -> None:
        from cyclonedds.pub import DataWriter
        from cyclonedds.qos import Policy

        policies = [*_policies(offer), Policy.History.KeepLast(1 if offer.keeps else 10)]
        if offer.hash is not None:
            policies.append(Policy.Userdata(f"typehash={offer.hash};".encode()))
        self.entity: Any = DataWriter(participant, topic, qos=_qos(policies))

    def write(self, payload: bytes, sent: int | None = None) -> None:
        """Write a message, as CDR with its head, sent now or at a time in nanoseconds.

        Raises:
            UnreadableError: the payload is not a message of the type.
        """
        from cyclonedds.core import DDSException

        sample = self.entity.topic.data_type()
        sample.payload = payload
        try:
            self.entity.write(sample, sent)
        except DDSException as error:
            raise UnreadableTypeError(str(error)) from None

    @property
    def readers(self) -> int:
        """The number of its readers."""
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
