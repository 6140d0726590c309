"""A Foxglove WebSocket server as a source: foxglove_bridge on a robot, or a program with the SDK.

The server is not trusted: the size of its messages and the time for its answers are limited, and a
connection that violates the protocol is closed.
"""

from __future__ import annotations

import logging
import re
import socket
import time
from contextlib import closing
from dataclasses import field
from ssl import SSLCertVerificationError, SSLError
from threading import Event as Flag
from typing import TYPE_CHECKING, assert_never
from urllib.parse import SplitResult

from compiler.files.checked_json import SchemaError
from fretc.watch.sources.foxglove_protocol import (
    SUBPROTOCOLS,
    Advertised,
    Advertisement,
    ChannelWithdrawal,
    Data,
    Greeting,
    Message,
    ServerTime,
    Status,
    read,
    subscribe,
    unsubscribe,
)
from fretc.watch.sources.middleware import Middleware
from fretc.watch.sources.source import Channel
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

PATIENCE = 5.0
"""Seconds for a server to answer: to the connection, with its greeting, to a ping."""
LARGEST = 2**26
"""The most bytes of a message."""
MOST_CHANNELS = 256
"""The most different channels of all bound topics together."""
MOST_STATUSES = 20
"""The most different status messages of a server that are shown."""
_PERIOD = 0.05
"""Seconds between two checks whether the watch has ended."""
_PING = 0.5
"""Seconds between two pings."""
_WAITING = 4
"""Frames that the library may buffer."""
_EXCERPT = 300
"""Characters of a server's text that are shown."""
_AGAIN = 0.1
"""Seconds after which the client subscribes again to a channel that the server did not know yet."""
_MOST_TRIES = 6
"""The most such attempts; each pause is twice the one before."""
_TOO_BIG = 1009
"""The code of a connection that was closed because of a too large message."""


class _GoneError(Exception):
    """The connection cannot be used any more; the message gives the reason."""


@dataclass(slots=True)
class _Connection:
    """One connection, from the server's greeting to its end."""

    socket: ClientConnection
    topics: frozenset[str]
    opened: float = field(default_factory=time.monotonic)
    subscriptions: dict[int, Channel] = field(default_factory=dict)
    of_channel: dict[int, int] = field(default_factory=dict)
    """The subscription for each channel id of the server."""
    count: int = 0
    """The number of all subscriptions so far."""
    heard: set[int] = field(default_factory=set)
    """Subscriptions with at least one message."""
    subscribed_at: float = 0.0
    """The time of the last subscription, on the monotonic clock."""
    tries: dict[int, int] = field(default_factory=dict)
    """For ids of the server, the number of further attempts."""
    again: dict[int, float] = field(default_factory=dict)
    """The times of further attempts."""
    answer: Flag | None = None
    """Set when the server has answered to the last ping; None: no ping is pending."""
    asked: int = 0
    """The receive time of the last ping."""
    asked_at: float = 0.0
    """The time of the last ping on the monotonic clock, in seconds."""

    def ping(self, now: int) -> None:
        """Ask the server for an answer, which comes after everything that was sent before."""
        self.answer, self.asked, self.asked_at = self.socket.ping(), now, time.monotonic()

    def subscribe(self, id: int, now: int) -> None:
        """Subscribe to a channel, by the id of the server."""
        self.socket.send(subscribe(self.of_channel[id], id))
        self.subscribed_at = time.monotonic()
        self.ping(now)

    def is_unknown_yet(self, text: str) -> bool:
        """Whether the server rejects a channel that it has advertised itself.

        The SDK advertises a channel a little before it accepts subscriptions to it. So the client
        subscribes again, by the same number: if the subscription exists, that changes nothing.
        """
        ids = {int(word) for word in re.findall(r"\d{1,10}", text)} & self.of_channel.keys()
        new = {id for id in ids if self.of_channel[id] not in self.heard}
        unknown_ids = {id for id in new if self.tries.get(id, 0) < _MOST_TRIES}
        for id in unknown_ids - self.again.keys():
            pause = _AGAIN * 2 ** self.tries.get(id, 0)
            self.tries[id] = self.tries.get(id, 0) + 1
            self.again[id] = time.monotonic() + pause
        return bool(unknown_ids)

    @property
    def subscribed(self) -> set[str]:
        """The subscribed topics."""
        return {channel.topic for channel in self.subscriptions.values()}


class Foxglove(Middleware):
    """A source for one server."""

    def __init__(self, url: SplitResult) -> None:
        """A source that is not yet open; `url` is from `address`."""
        self._host = url.hostname or ""
        self._port = url.port or (443 if url.scheme == "wss" else 80)
        host = f"[{self._host}]" if ":" in self._host else self._host
        super().__init__(f"{url.scheme}://{host}:{self._port}{url.path}")  # without a password
        self._url = url.geturl()
        self._channels: dict[Channel, Channel] = {}
        self._topics: set[str] = set()
        """Topics that the server has advertised."""
        self._warnings: set[Diagnostic] = set()
        self._statuses = 0

    def _listen(self, topics: list[str]) -> bool:
        try:
            from websockets.exceptions import WebSocketException
            from websockets.sync.client import connect
            from websockets.typing import Subprotocol
        except ImportError as error:
            self._lost(diagnostic("no_websockets", why=str(error), help=install_help("live")))
            return False
        logging.getLogger("websockets").addHandler(logging.NullHandler())
        connection = None
        try:
            with (
                closing(self._socket()) as plain,
                connect(
                    self._url,
                    sock=plain,
                    subprotocols=[Subprotocol(name) for name in SUBPROTOCOLS],
                    compression=None,
                    open_timeout=PATIENCE,
                    ping_interval=None,
                    close_timeout=_PING,
                    max_size=LARGEST,
                    max_queue=_WAITING,
                ) as client,
            ):
                connection = _Connection(client, frozenset(topics))
                self._converse(connection)
        except (OSError, EOFError, ValueError, WebSocketException, _GoneError) as error:
            self._lost(_server_not_reached(self.name, *_reason(error)))
        return connection is not None and bool(connection.heard)

    def _socket(self) -> socket.socket:
        """Open a connection; it is also lost if the server does not accept data."""
        plain = socket.create_connection((self._host, self._port), PATIENCE)
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux; elsewhere the system waits longer
            plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, int(1000 * PATIENCE))
        return plain

    # One connection

    def _converse(self, connection: _Connection) -> None:
        """Receive messages until the watch ends.

        Raises:
            _GoneError, OSError, WebSocketException: the server is of no use any more.
            SchemaError: it uses another protocol.
        """
        if connection.socket.subprotocol is None:
            raise _GoneError("it does not use the Foxglove protocol")
        greeting = read(connection.socket.recv(timeout=PATIENCE), connection.topics)
        if not isinstance(greeting, Greeting):
            raise _GoneError("it does not begin with `serverInfo`")
        if self._alive is None:
            self._opened(self.name)
        connection.ping(self._mailbox.now)
        while not self._closed.is_set():
            self._look(connection)
            try:
                message = connection.socket.recv(timeout=_PERIOD)
            except TimeoutError:
                continue
            item = read(message, connection.topics)
            if item is not None:
                self._take(connection, item)

    def _look(self, connection: _Connection) -> None:
        """Check that the server answers, and still offers all its earlier topics."""
        now = time.monotonic()
        for id in [id for id, due in connection.again.items() if due <= now]:
            del connection.again[id]
            if id in connection.of_channel:
                connection.subscribe(id, self._mailbox.now)
        if connection.answer is not None:
            if connection.answer.is_set():
                connection.answer = None
                self._is_alive(connection.asked)
            elif now - connection.asked_at > PATIENCE:
                raise _GoneError(f"it has not answered for {PATIENCE:g} s")
        elif now - connection.asked_at > _PING:
            connection.ping(self._mailbox.now)
        if self._is_lost:
            is_answered = connection.answer is None and not connection.again
            is_answered &= now - connection.subscribed_at > _AGAIN
            is_whole = is_answered and self._topics <= connection.subscribed
            if is_whole or now - connection.opened > PATIENCE:
                self._opened(self.name)

    def _take(self, connection: _Connection, message: Message) -> None:
        match message:
            case Data(subscription, time, payload):
                channel = connection.subscriptions.get(subscription)
                if channel is not None:
                    connection.heard.add(subscription)
                    self._put(channel, payload, time)
            case Advertisement(channels):
                for advertised in channels:
                    self._subscribe(connection, advertised)
            case ChannelWithdrawal(ids):
                for id in ids:
                    self._withdraw(connection, id)
            case Status(is_grave, text):
                if is_grave and not connection.is_unknown_yet(text[:_EXCERPT]):
                    self._repeat(text)
            case ServerTime():
                self._warn_once(diagnostic("simulated_time"))
            case Greeting():
                pass  # a new session advertises its channels again
            case _:
                assert_never(message)

    def _subscribe(self, connection: _Connection, advertised: Advertised) -> None:
        channel = advertised.channel
        if isinstance(channel, str):
            self._warn_once(diagnostic("unreadable_channel", topic=advertised.topic, why=channel))
            return
        is_new = channel not in self._channels
        most = max(len(self._channels) * is_new, len(connection.subscriptions))
        if most >= MOST_CHANNELS:
            self._warn_once(diagnostic("too_many_channels", most=MOST_CHANNELS))
            return
        channel = self._channels.setdefault(channel, channel)
        before = connection.of_channel.get(advertised.id)
        if before is not None:
            if connection.subscriptions[before] == channel:
                return
            del connection.subscriptions[before]
            connection.socket.send(unsubscribe(before))
        if channel.topic in connection.subscribed:
            self._warn_once(diagnostic("several_channels", topic=channel.topic))
        connection.count += 1
        connection.of_channel[advertised.id] = connection.count
        connection.subscriptions[connection.count] = channel
        self._topics.add(channel.topic)
        connection.subscribe(advertised.id, self._mailbox.now)

    def _withdraw(self, connection: _Connection, id: int) -> None:
        subscription = connection.of_channel.pop(id, None)
        if subscription is None:
            return
        topic = connection.subscriptions.pop(subscription).topic
        if topic not in connection.subscribed:
            self._topics.discard(topic)
            self._warn_once(diagnostic("channel_withdrawn", topic=topic))

    def _repeat(self, text: str) -> None:
        """Report a status message of the server."""
        problem = diagnostic("server_status", text=text[:_EXCERPT])
        if problem not in self._warnings:
            self._statuses += 1
            few = self._statuses <= MOST_STATUSES
            self._warn_once(problem if few else diagnostic("more_statuses", most=MOST_STATUSES))

    def _warn_once(self, problem: Diagnostic) -> None:
        if problem not in self._warnings:
            self._warnings.add(problem)
            self._warn(problem)


_TRUST = "set SSL_CERT_FILE to the file with the authority that signed it"


def _reason(error: Exception) -> tuple[str, str | None]:
    """Why a connection has ended, and a special remedy, if there is one."""
    from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus

    match error:
        case SSLCertVerificationError():
            return f"its certificate is not trusted: {error.verify_message}", _TRUST
        case SSLError():
            return "it does not use TLS", "write `ws://` in place of `wss://`"
        case TimeoutError():
            return f"it has not answered within {PATIENCE:g} s", None
        case OSError():
            return error.strerror or str(error), None
        case SchemaError():
            return f"it violates the protocol: {str(error)[:_EXCERPT]}", None
        case InvalidStatus():
            status = f"HTTP status {error.response.status_code}"
            return f"{status}: check that a Foxglove server is at this address", None
        case InvalidHandshake() | EOFError():
            return "it is not a WebSocket server with the Foxglove protocol", None
        case ConnectionClosed(sent=sent) if sent is not None and sent.code == _TOO_BIG:
            return f"it has sent a message of more than {LARGEST >> 20} MiB", None
        case ConnectionClosed(rcvd=rcvd) if rcvd is not None:
            why = f": {rcvd.reason[:_EXCERPT]}" if rcvd.reason else ""
            return f"it has closed the connection{why}", None
        case ConnectionClosed():
            return "the connection was lost", None
        case _:
            return str(error)[:_EXCERPT], None


def _server_not_reached(name: str, why: str, fix: str | None) -> Diagnostic:
    return diagnostic(
        "server_not_reached",
        name=name,
        why=why,
        help=fix or "start the server on the robot (`ros2 run foxglove_bridge foxglove_bridge`)",
    )
