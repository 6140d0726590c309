"""A Zenoh session: the connection to one router or peer, through the library of Zenoh.

It only listens: it announces nothing, opens no port, and looks for no others. What arrives is
passed on in the thread of the network, so nothing waits in a queue that has no limit.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import suppress
from threading import Event as Flag
from typing import Any

from fretc.logs.messages.ros2_types import definitions
from fretc.watch.zenoh.keys import LONGEST_ATTACHMENT
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.messages import diagnostic

LARGEST = 2**26
"""The most bytes of a message."""
_REASON = 300
"""Characters of an error of the library that are shown."""

OnMessage = Callable[[str, bytes, bytes], None]
"""The key, the payload, and the attachment; without one, no bytes."""
OnToken = Callable[[str, bool], None]
"""The key, and whether the token is there."""


class SessionError(Exception):
    """There is no session; the text gives the reason."""


def unless_importable() -> Diagnostic | None:
    """F908 if the packages of the extra cannot be imported."""
    try:
        import zenoh.ext  # noqa: F401

        definitions("std_msgs/msg/Header")
    except Exception as error:  # a package, or a library of it, is missing
        return diagnostic("no_zenoh", error=error, help=install_help("zenoh"))
    return None


class ZenohSession:
    """A session with one router or peer."""

    def __init__(self, locator: str, patience: float) -> None:
        """Connect.

        Args:
            locator: `tcp/localhost:7447`.
            patience: seconds to wait for an answer.

        Raises:
            SessionError: nothing answers there, or the locator is invalid.
        """
        import zenoh

        self.lost = Flag()
        """Set once the connection is lost."""
        try:
            self._session: Any = zenoh.open(_configuration(locator, patience))
        except zenoh.ZError:  # it does not tell more than the locator
            raise SessionError("no router of Zenoh answers there") from None
        events = self._session.info.declare_transport_events_listener(
            _direct(self._on_transport), history=True
        )
        self._declared: list[Any] = [events]
        if not self._session.info.transports():
            self.lost.set()

    def _on_transport(self, event: Any) -> None:
        from zenoh import SampleKind

        if event.kind == SampleKind.DELETE:
            self.lost.set()

    def subscribe(self, key: str, on_message: OnMessage) -> None:
        """Pass on the messages with such keys, first those that publishers keep for late readers.

        Raises:
            SessionError: the session is closed.
        """
        from zenoh import SampleKind, ZError
        from zenoh.ext import HistoryConfig, declare_advanced_subscriber

        def take(sample: Any) -> None:
            if sample.kind == SampleKind.PUT:
                on_message(str(sample.key_expr), sample.payload.to_bytes(), _attached(sample))

        history = HistoryConfig(detect_late_publishers=True)
        try:
            subscriber = declare_advanced_subscriber(
                self._session, key, _direct(take), history=history
            )
        except ZError as error:
            raise SessionError(_reason(error)) from None
        self._declared.append(subscriber)

    def follow(self, key: str, on_token: OnToken) -> None:
        """Pass on the liveliness tokens with such keys: those there are, and all changes.

        Raises:
            SessionError: the session is closed.
        """
        from zenoh import SampleKind, ZError

        def take(sample: Any) -> None:
            on_token(str(sample.key_expr), sample.kind == SampleKind.PUT)

        try:
            follower = self._session.liveliness().declare_subscriber(
                key, _direct(take), history=True
            )
        except ZError as error:
            raise SessionError(_reason(error)) from None
        self._declared.append(follower)

    def ask(self, key: str, patience: float) -> Flag:
        """Ask for something that nobody has; the flag is set by the answer, if there is one.

        Raises:
            SessionError: the session is closed.
        """
        from zenoh import ZError

        answered, asked = Flag(), time.monotonic()

        def end() -> None:
            if time.monotonic() - asked < patience:  # later, the library itself has ended it
                answered.set()

        try:
            self._session.get(key, _direct(lambda reply: None, end), timeout=2 * patience)
        except ZError as error:
            raise SessionError(_reason(error)) from None
        return answered

    def request(
        self,
        service: str,
        payload: bytes,
        attached: bytes,
        patience: float,
        on_answer: Callable[[bytes], None],
        on_end: Callable[[], None],
    ) -> None:
        """Ask services; each answer is passed on, and then the end, which always comes.

        Args:
            service: the key expression of the services.
            payload: the request.
            attached: the attachment of the request.
            patience: seconds for all answers.
            on_answer: takes the payload of an answer.
            on_end: called when no answer can come any more.

        Raises:
            SessionError: the session is closed.
        """
        from zenoh import ConsolidationMode, QueryTarget, ZError

        def take(reply: Any) -> None:
            if reply.ok is not None:
                on_answer(reply.ok.payload.to_bytes())

        try:
            self._session.get(
                service,
                _direct(take, on_end),
                target=QueryTarget.ALL,
                consolidation=ConsolidationMode.NONE,
                timeout=patience,
                payload=payload,
                attachment=attached,
            )
        except ZError as error:
            raise SessionError(_reason(error)) from None

    def close(self) -> None:
        """End the session."""
        from zenoh import ZError

        self._declared.clear()
        with suppress(ZError):
            self._session.close()


def _configuration(locator: str, patience: float) -> Any:
    import zenoh

    configuration = zenoh.Config()
    settings: dict[str, object] = {
        "mode": "client",
        "connect/endpoints": [locator],
        "connect/timeout_ms": 0,  # one attempt; the next one is fretc's own
        "connect/exit_on_failure": True,
        "transport/unicast/open_timeout": int(1000 * patience),
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "adminspace/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/link/rx/max_message_size": LARGEST,
    }
    for name, value in settings.items():
        configuration.insert_json5(name, json.dumps(value))
    return configuration


def _direct(callback: Callable[[Any], None], end: Callable[[], None] | None = None) -> Any:
    """A handler that runs in the thread of the network."""
    from zenoh.handlers import Callback

    return Callback(callback, end, indirect=False)


def _attached(sample: Any) -> bytes:
    attached = sample.attachment
    if attached is None or len(attached) > LONGEST_ATTACHMENT:
        return b""
    return bytes(attached.to_bytes())


def _reason(error: Exception) -> str:
    """The first sentence of an error of the library, without a place in its source."""
    return str(error).partition(" at /")[0].rstrip(". ")[:_REASON]
