"""Messages of ROS 2 as a source, read from Zenoh as rmw_zenoh sends them, without ROS.

The key of a message states its type. Publishers announce themselves by tokens, and number their
messages, so that lost messages are known. Nobody is trusted: what has another form is not read.
"""

from __future__ import annotations

import time
from dataclasses import field
from functools import partial
from threading import Event as Flag
from threading import Lock

from fretc.watch.sources.dds_domain import domain_id
from fretc.watch.sources.mailbox import WAIT
from fretc.watch.sources.middleware import Middleware, several_publishers
from fretc.watch.sources.ros2_definitions import definition, no_definition
from fretc.watch.sources.source import Channel, Missed, Reconnected
from fretc.watch.sources.type_service import request
from fretc.watch.zenoh.keys import (
    Attachment,
    Token,
    attached,
    attachment,
    has_key,
    keys_of_messages,
    keys_of_tokens,
    kind_of_message,
    token,
)
from fretc.watch.zenoh.publishers import Publisher, Publishers
from fretc.watch.zenoh.sequence_numbers import Numbers
from fretc.watch.zenoh.session import SessionError, ZenohSession, unless_importable
from fretc.watch.zenoh.type_questions import Held, Question, TypeQuestions
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic

LOCATOR = "tcp/localhost:7447"
"""Where the router of rmw_zenoh listens."""
PATIENCE = 5.0
"""Seconds for the other side to answer."""
MOST_KINDS = 20
"""The most keys of a topic, thus types of its messages; further ones are not read."""
_ANSWERS = 3.0
"""Seconds for a node to describe a type."""
_ASKER = bytes(range(1, 17))
"""What identifies fretc in its requests."""
_PING = 0.5
"""Seconds between two questions whether the other side still answers."""
_NAMES = 4
"""The most names of nodes that are shown, of so many characters each."""
_NAME = 80
_CLOCK = "/clock"
_QUESTION = "fretc/question"
"""What fretc asks for: nobody has it, so the other side answers at once."""


@dataclass(slots=True)
class _Connection:
    """One session, from its begin to its end."""

    session: ZenohSession
    domain: int
    topics: frozenset[str]
    publishers: Publishers = field(default_factory=Publishers)
    is_open: bool = False
    """Whether the other side knows what fretc listens to."""
    answer: Flag | None = None
    """Set by the answer to the last question; None: no question is open."""
    asked: int = 0
    """The receive time of the last question."""
    asked_at: float = float("-inf")
    """The same on the monotonic clock, in seconds."""
    answers: bool = False
    """Whether there was ever an answer."""
    is_mute: bool = False
    """Whether the other side does not answer to questions at all."""

    def ask(self, now: int) -> None:
        """Ask whether the other side answers."""
        self.asked, self.asked_at = now, time.monotonic()
        self.answer = self.session.ask(f"{self.domain}/{_QUESTION}", PATIENCE)


class Zenoh(Middleware):
    """The router or peer at a locator, and the domain in `ROS_DOMAIN_ID`."""

    def __init__(self, locator: str = LOCATOR) -> None:
        """A source that is not yet open."""
        super().__init__(locator)
        self._lock = Lock()
        """Held by the threads of the network, and by that of the source."""
        self._numbers = Numbers()
        self._channels: dict[str, dict[str, Channel | None]] = {}
        """For each topic and key the channel; None: it is not read."""
        self._questions = TypeQuestions()
        self._missed: Missed | None = None
        """Lost messages that are reported after the next connection."""
        self._unnumbered: dict[str, int] = {}
        """The last message without a number, by key."""
        self._known: set[tuple[Code, str]] = set()
        """The diagnostics that were reported for a topic."""

    def _listen(self, topics: list[str]) -> bool:
        number = domain_id()
        problem = number if isinstance(number, Diagnostic) else unless_importable()
        if problem is not None:
            self._lost(problem)
            return False
        assert isinstance(number, int)
        connection = None
        try:
            session = ZenohSession(self.name, PATIENCE)
            try:
                connection = _Connection(session, number, self._named(topics))
                self._follow(connection)
                while not self._closed.wait(WAIT):
                    self._look(connection)
            finally:
                with self._lock:
                    self._questions.drop()
                session.close()
        except SessionError as error:
            with self._lock:
                self._lost(diagnostic("zenoh_not_reached", locator=self.name, why=error))
        return connection is not None and connection.is_open

    def _named(self, topics: list[str]) -> frozenset[str]:
        """The topics that have keys."""
        named = frozenset(filter(has_key, topics))
        for topic in topics:
            if topic not in named:
                self._tell_once(topic, _not_read(topic, "its name is none of ROS 2"))
        return named

    def _follow(self, connection: _Connection) -> None:
        """Listen to the publishers of the topics, then to their messages.

        Raises:
            SessionError: the session is closed.
        """
        with self._lock:
            self._numbers.begin(None)
        for topic in {*connection.topics, _CLOCK}:
            meet = partial(self._meet, connection, topic)
            connection.session.follow(keys_of_tokens(connection.domain, topic), meet)
        for topic in connection.topics:
            take = partial(self._take, connection, topic)
            connection.session.subscribe(keys_of_messages(connection.domain, topic), take)

    # The connection

    def _look(self, connection: _Connection) -> None:
        """Check that the other side answers; what it did before an answer has arrived.

        Raises:
            SessionError: it does not, or the connection is lost.
        """
        if connection.session.lost.is_set():
            raise SessionError("the connection was lost")
        self._ask_for_types(connection)
        now, waited = self._mailbox.now, time.monotonic() - connection.asked_at
        if connection.is_mute:
            if waited > _PING:
                self._passed(connection, connection.asked)
                connection.asked, connection.asked_at = now, time.monotonic()
        elif connection.answer is None:
            if waited > _PING:
                connection.ask(now)
        elif connection.answer.is_set():
            connection.answer, connection.answers = None, True
            self._passed(connection, connection.asked)
            with self._lock:
                self._is_alive(connection.asked)
        elif waited > PATIENCE:
            if connection.answers:
                raise SessionError(f"it has not answered for {PATIENCE:g} s")
            connection.answer, connection.is_mute = None, True

    def _passed(self, connection: _Connection, until: int) -> None:
        """The connection was there until this time: tokens that ended before are of the robot."""
        with self._lock:
            if not connection.is_open:
                self._begin(connection)
            self._part(connection, connection.publishers.ended(until))

    def _begin(self, connection: _Connection) -> None:
        """From now on, the other side passes on what fretc listens to."""
        self._numbers.begin(None if self._alive is None else self._mailbox.now)
        self._opened(f"Zenoh at {self.name}, domain {connection.domain}")
        connection.is_open = True
        if self._missed is not None:
            self._mailbox.tell(self._missed)
            self._missed = None

    # Publishers

    def _meet(self, connection: _Connection, topic: str, name: str, is_there: bool) -> None:
        """Take a token that has appeared or disappeared."""
        found = token(name)
        with self._lock:
            if found is None:
                return
            if not is_there:
                connection.publishers.disappear(name, self._mailbox.now)
            elif topic == _CLOCK:
                self._tell_once(topic, diagnostic("simulated_time"))
            if is_there and topic in connection.topics:
                self._greet(connection, topic, name, found)

    def _greet(self, connection: _Connection, topic: str, name: str, found: Token) -> None:
        now, publishers = self._mailbox.now, connection.publishers
        publisher = Publisher(topic, found, now, is_early=not connection.is_open)
        before = publishers.appear(name, publisher)
        if before is not None and before.gone is not None:
            times = [
                self._numbers.last_of(found.key, before.since),
                self._unnumbered.get(found.key),
            ]
            since = min((time for time in times if time is not None), default=before.gone)
            self._mailbox.tell(Reconnected(min(since, now), now))
        self._question(connection, found.key)
        there = publishers.count(topic)
        if there > 1 and (Code.SEVERAL_PUBLISHERS, topic) not in self._known:
            names = [node[:_NAME] for node in publishers.nodes(topic)[:_NAMES]]
            self._tell_once(topic, several_publishers(topic, there, names))

    def _part(self, connection: _Connection, ended: list[Publisher]) -> None:
        publishers = connection.publishers
        for key in {each.token.key for each in ended}:
            if not publishers.count(key):
                self._numbers.gone(key)
        for topic in sorted({each.topic for each in ended}):
            if not publishers.count(topic):
                self._warn(diagnostic("publisher_gone", topic=topic))

    # Messages

    def _take(
        self, connection: _Connection, topic: str, key: str, payload: bytes, attachment_: bytes
    ) -> None:
        """Take a message, at once or when it is known how to read it."""
        message = Held(topic, payload, attachment_)
        with self._lock:
            if key not in self._channels.get(topic, {}):
                self._question(connection, key)
            if not self._questions.holds(key, message):
                self._accept(connection, key, message)

    def _accept(self, connection: _Connection, key: str, message: Held) -> None:
        """Pass on a message."""
        topic, payload = message.topic, message.payload
        channel = self._channel(topic, key)
        if channel is None:
            return
        of = attachment(message.attached)
        if of is None:
            self._tell_once(topic, diagnostic("unnumbered_messages", topic=topic))
            self._unnumbered[key] = self._put(channel, payload)
            return
        since = connection.publishers.since(key)
        missed = self._numbers.missed(key, of, since, self._mailbox.now)
        if missed is not None:
            self._miss(connection, missed)
        self._numbers.arrived(key, of, self._put(channel, payload, of.sent))

    def _miss(self, connection: _Connection, missed: Missed) -> None:
        """Report lost messages, unless the connection is lost too: then once it is back."""
        if connection.is_open and not self._is_lost:
            self._mailbox.tell(missed)
            return
        before = self._missed or missed
        count = missed.count + (0 if self._missed is None else before.count)
        self._missed = Missed(
            min(before.since, missed.since), max(before.until, missed.until), count
        )

    def _channel(self, topic: str, key: str) -> Channel | None:
        """The channel of a key; None: its messages are not read."""
        channels = self._channels.setdefault(topic, {})
        if key in channels:
            return channels[key]
        kind = kind_of_message(key)
        if kind is None:
            self._tell_once(topic, _not_read(topic, "the key of its messages states no type"))
            return None
        if len(channels) >= MOST_KINDS:
            why = f"there are more than {MOST_KINDS} types of messages of the topic"
            self._tell_once(topic, _not_read(topic, why))
            return None
        text = definition(kind.type, kind.hash) or self._questions.definition(key)
        if text is None:
            problem = no_definition(topic, kind.type, kind.hash, "no node describes it")
            self._tell_once(topic, problem)
        channels[key] = Channel(
            topic, "cdr", kind.type, "" if text is None else "ros2msg", (text or "").encode()
        )
        return channels[key]

    # Definitions

    def _question(self, connection: _Connection, key: str) -> None:
        """Let the nodes that publish messages with this key be asked if their type is unknown."""
        kind = kind_of_message(key)
        if kind is None or kind.hash is None or not self._questions.may_ask(key):
            return
        if definition(kind.type, kind.hash) is None:
            nodes = connection.publishers.nodes_of(key)
            self._questions.ask(connection.domain, key, kind, nodes)

    def _ask_for_types(self, connection: _Connection) -> None:
        """Send the questions since the last call.

        Raises:
            SessionError: the session is closed.
        """
        with self._lock:
            questions = self._questions.unsent()
        for question in questions:
            for service in question.services:
                connection.session.request(
                    service,
                    request(question.offer),
                    attached(Attachment(1, time.time_ns(), _ASKER)),
                    _ANSWERS,
                    partial(self._answered, question),
                    partial(self._ended, connection, question),
                )

    def _answered(self, question: Question, payload: bytes) -> None:
        with self._lock:
            question.take(payload)

    def _ended(self, connection: _Connection, question: Question) -> None:
        with self._lock:
            for message in self._questions.end(question):
                self._accept(connection, question.key, message)

    def _tell_once(self, topic: str, problem: Diagnostic) -> None:
        if (problem.code, topic) not in self._known:
            self._known.add((problem.code, topic))
            self._warn(problem)


def _not_read(topic: str, why: str) -> Diagnostic:
    return diagnostic("publisher_not_read", topic=topic, why=why)
