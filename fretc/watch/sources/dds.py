"""Messages of ROS 2 as a source, read from DDS without ROS.

A DDS domain has no master: publishers appear and disappear. Each kind of publisher of a topic (by
its type and offer) has a reader of its own, which receives the messages of these publishers. The
arrival time of a message is the time at which this thread gets it.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import field

from fretc.logs.messages import ros2_types
from fretc.watch.sources.dds_domain import DdsPublisher, DdsWriter, Domain, Reader, join
from fretc.watch.sources.dds_types import Offer, UnreadableTypeError
from fretc.watch.sources.mailbox import WAIT, Mailbox
from fretc.watch.sources.middleware import Middleware, several_publishers
from fretc.watch.sources.ros2_definitions import definition, no_definition
from fretc.watch.sources.source import Channel, Problem, Reconnected
from fretc.watch.sources.type_service import TypeService
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.stop_supervisor import Status

MOST_KINDS = 20
"""The most kinds of publishers of a topic; further kinds are not read."""
_MOST_PUBLISHERS = 10_000
"""The most publishers that are kept after they disappeared."""
_SOON = 3 * 10**9
"""Nanoseconds in which a reader and a publisher normally match."""
_CLOCK = "/clock"
_PERIOD = 0.5
"""Seconds between two publications of states."""
_ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
_PARTS = {
    _ARRAY,
    "diagnostic_msgs/msg/DiagnosticStatus",
    "diagnostic_msgs/msg/KeyValue",
    "std_msgs/msg/Header",
    "builtin_interfaces/msg/Time",
}


class Dds(Middleware):
    """The domain in `ROS_DOMAIN_ID`."""

    def __init__(self) -> None:
        """A source that is not yet open."""
        super().__init__("dds")
        self._statuses: Sequence[Status] = ()

    def diagnose(self, statuses: Sequence[Status]) -> None:
        """Set the statuses that the thread publishes, twice a second."""
        self._statuses = statuses

    def _listen(self, topics: list[str]) -> bool:
        """Receive messages of the topics; the name of a DDS topic has no leading slash."""
        domain = join()
        if isinstance(domain, Diagnostic):
            self._lost(domain)
            return False
        try:
            self._opened(f"DDS domain {domain.number}")
            listening = _Listening(domain, frozenset(topics), self._mailbox)
            diagnosing = _Diagnosing(domain)
            while not self._closed.is_set():
                domain.wait(WAIT)
                listening.look()
                diagnosing.publish(self._statuses)
        except Exception as error:  # Cyclone DDS may raise any exception for data of others
            self._lost(diagnostic("dds_fails", kind=type(error).__name__, error=error))
        finally:
            domain.close()
        return True


@dataclass(slots=True)
class _Kind:
    """Publishers of one topic with the same offer."""

    reader: Reader | None
    """None: their messages cannot be read."""
    channel: Channel


@dataclass(slots=True)
class _Peer:
    """A publisher, present or gone."""

    id: str
    topic: str
    offer: Offer
    last: int
    """The time of its last message."""
    there: bool = True
    early: set[tuple[int | None, int]] = field(default_factory=set)
    """Messages that arrived through any reader before its own one matched: send time and hash."""


class _Listening:
    """The publishers of the topics, and their messages."""

    def __init__(self, domain: Domain, topics: frozenset[str], mailbox: Mailbox) -> None:
        self._domain, self._topics, self._mailbox = domain, topics, mailbox
        self._kinds: dict[tuple[str, Offer], _Kind] = {}
        self._peers: dict[int, _Peer] = {}
        """Publishers by handle, also those that are gone, because their last messages may still
        arrive."""
        self._lost: dict[str, int] = {}
        """Publishers that are gone, by id: the time of their last message."""
        self._unmatched: dict[int, int] = {}
        """Publishers that do not match their own reader yet: since when."""
        self._types = TypeService(domain, lambda: mailbox.now)
        self._known: set[tuple[Code, str]] = set()
        """The diagnostics that were reported for a topic."""

    def look(self) -> None:
        """Pass on the messages since the last call."""
        for offer in self._types.answers():
            self._open_again(offer)
        matched = self._matched()
        for kind in tuple(self._kinds.values()):
            if kind.reader is not None:
                self._read(kind, kind.reader)
        for handle in matched:
            self._unmatched.pop(handle, None)
        self._meet()  # the last messages of a publisher come before its end

    def _read(self, kind: _Kind, reader: Reader) -> None:
        for sample in reader.samples():
            if sample.publisher not in self._peers:
                self._meet()
            peer, channel = self._peers.get(sample.publisher), kind.channel
            if peer is not None:
                own, key = self._kinds[peer.topic, peer.offer], (sample.sent, hash(sample.payload))
                if key in peer.early and sample.sent is not None:
                    continue  # the message came through another reader, too
                if sample.publisher in self._unmatched:
                    peer.early.add(key)
                elif own is not kind:
                    continue  # the publisher's own reader receives it
                channel, peer.last = own.channel, self._mailbox.now
            self._mailbox.put(channel, sample.payload, sample.sent)

    # Publishers

    def _meet(self) -> None:
        for publisher in self._domain.publishers():
            if publisher.offer is None:
                self._part(publisher)
            elif publisher.topic in self._topics:
                self._greet(publisher, publisher.offer)
            elif publisher.topic == _CLOCK:
                self._tell_once(_CLOCK, diagnostic("simulated_time"))

    def _greet(self, publisher: DdsPublisher, offer: Offer) -> None:
        now, topic = self._mailbox.now, publisher.topic
        if topic == _CLOCK:
            self._tell_once(topic, diagnostic("simulated_time"))
        while len(self._peers) >= _MOST_PUBLISHERS:
            del self._peers[next(iter(self._peers))]
        self._peers[publisher.handle] = _Peer(publisher.id, topic, offer, now)
        since = self._lost.pop(publisher.id, None)
        if since is not None:
            self._mailbox.tell(Reconnected(since, now))
        if (topic, offer) not in self._kinds:
            if definition(offer.type, offer.hash) is None and self._types.asks(
                publisher.participant, offer
            ):
                self._kinds[topic, offer] = _Kind(None, _channel(topic, offer, None))
            else:
                self._open(topic, offer)
        if self._kinds[topic, offer].reader is not None:
            self._unmatched[publisher.handle] = now
        there = sum(peer.there for peer in self._peers.values() if peer.topic == topic)
        if there > 1:
            self._tell_once(topic, several_publishers(topic, there))

    def _part(self, publisher: DdsPublisher) -> None:
        peer = self._peers.get(publisher.handle)
        if peer is None or not peer.there:
            return
        peer.there = False
        self._unmatched.pop(publisher.handle, None)
        while len(self._lost) >= _MOST_PUBLISHERS:
            del self._lost[next(iter(self._lost))]
        self._lost[peer.id] = peer.last
        if not any(each.there and each.topic == peer.topic for each in self._peers.values()):
            self._mailbox.tell(Problem(diagnostic("publisher_gone", topic=peer.topic)))

    def _open(self, topic: str, offer: Offer) -> None:
        """Open a reader for a new kind of publishers."""
        text = definition(offer.type, offer.hash) or self._types.definition(offer)
        if text is None:
            self._tell_once(
                topic, no_definition(topic, offer.type, offer.hash, "no node describes it")
            )
        kind = self._kinds[topic, offer] = _Kind(None, _channel(topic, offer, text))
        if sum(each == topic for each, _ in self._kinds) > MOST_KINDS:
            self._tell_once(
                topic,
                _not_read(
                    topic, f"there are more than {MOST_KINDS} kinds of publishers of the topic"
                ),
            )
            return
        try:
            kind.reader = self._domain.reader(topic, offer, text)
        except UnreadableTypeError as error:
            self._tell_once(topic, _not_read(topic, str(error)))

    def _open_again(self, offer: Offer) -> None:
        """Open the readers that have waited for a definition."""
        for topic, other in [*self._kinds]:
            if other == offer:
                self._open(topic, offer)
        for handle, peer in self._peers.items():
            kind = self._kinds[peer.topic, peer.offer]
            if peer.there and peer.offer == offer and kind.reader is not None:
                self._unmatched[handle] = self._mailbox.now

    def _matched(self) -> list[int]:
        """Publishers that match their readers, or never will, for example because of their type."""
        handles = []
        for handle, since in self._unmatched.items():
            peer = self._peers.get(handle)
            reader = self._kinds[peer.topic, peer.offer].reader if peer is not None else None
            if peer is None or reader is None or reader.matches(handle):
                handles.append(handle)
            elif self._mailbox.now - since > _SOON:
                handles.append(handle)
                why = f"its `{peer.offer.type}` has other fields or another encoding"
                self._tell_once(peer.topic, _not_read(peer.topic, why))
        return handles

    def _tell_once(self, topic: str, problem: Diagnostic) -> None:
        if (problem.code, topic) not in self._known:
            self._known.add((problem.code, topic))
            self._mailbox.tell(Problem(problem))


class _Diagnosing:
    """`diagnostic_msgs/DiagnosticArray` on `/diagnostics`, as a ROS 2 node publishes it."""

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._writer: DdsWriter | None = None
        self._last = float("-inf")

    def publish(self, statuses: Sequence[Status]) -> None:
        """Publish the statuses, twice a second, if there are any."""
        if not statuses or time.monotonic() - self._last < _PERIOD:
            return
        self._last = time.monotonic()
        if self._writer is None:
            digest, text = [*ros2_types.definitions(_ARRAY).items()][-1]
            offer = Offer(_ARRAY, digest, reliable=True)
            self._writer = self._domain.writer("/diagnostics", offer, text)
        with suppress(UnreadableTypeError):  # a reader is too slow; the next statuses follow soon
            self._writer.write(_array(statuses, time.time_ns()))


def _array(statuses: Sequence[Status], now: int) -> bytes:
    """The statuses as CDR."""
    store = ros2_types.latest()
    own = {name.rpartition("/")[2]: type_ for name, type_ in store.types.items() if name in _PARTS}

    def text(said: str) -> str:
        return said.encode(errors="replace").decode()

    statuses_of_array = [
        own["DiagnosticStatus"](
            level=status.level,
            name=text(status.name),
            message=text(status.message),
            hardware_id="",
            values=[own["KeyValue"](key=text(k), value=text(v)) for k, v in status.values],
        )
        for status in statuses
    ]
    seconds, rest = divmod(now, 10**9)
    header = own["Header"](stamp=own["Time"](sec=seconds, nanosec=rest), frame_id="")
    return bytes(
        store.serialize_cdr(own["DiagnosticArray"](header=header, status=statuses_of_array), _ARRAY)
    )


def _channel(topic: str, offer: Offer, text: str | None) -> Channel:
    if text is None:
        return Channel(topic, "cdr", offer.type, "", b"")
    return Channel(topic, "cdr", offer.type, "ros2msg", text.encode())


def _not_read(topic: str, why: str) -> Diagnostic:
    return diagnostic("publisher_not_read", topic=topic, why=why)
