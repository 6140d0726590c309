"""A Foxglove server with the topics of the robot, and the state of each requirement.

Source: https://docs.foxglove.dev/docs/sdk, the package foxglove-sdk.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fretc.audit.outputs.annotations import state_topic
from fretc.watch.sources.source import Arrival, Channel
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.messages import diagnostic
from monitors.kernel.verdicts import Truth
from monitors.stop_supervisor import State, Status

if TYPE_CHECKING:
    import foxglove

HOST, PORT = "127.0.0.1", 8765
"""The default address: this machine, the usual port."""
NAME = "fretc.RequirementState"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
_ANSWERS: dict[Truth, str] = {True: "yes", None: "perhaps", False: "no"}
_TEXT, _WHOLE = {"type": "string"}, {"type": "integer"}
_ALWAYS = {
    "requirement": _TEXT,
    "level": _TEXT,
    "message": _TEXT,
    "verdict": _TEXT,
    "obligation_pending": _TEXT,
}
_TIMES = ("triggered_ns", "open_ns", "deadline_ns", "violated_ns")
SCHEMA = {
    "title": NAME,
    "type": "object",
    "properties": {
        **_ALWAYS,
        "level": {**_TEXT, "enum": [*LEVELS]},
        "obligation_pending": {**_TEXT, "enum": [*_ANSWERS.values()]},
        **dict.fromkeys(_TIMES, _WHOLE),
    },
    "required": [*_ALWAYS],
}
"""Plain types only, which panels of Foxglove can read: an absent time is left out."""


class FoxgloveServer:
    """A server that sends arriving messages and the states of requirements to all clients."""

    def __init__(self, host: str, port: int) -> None:
        """Open the server; port 0 picks a free one.

        Raises:
            ImportError: the package is not installed.
            RuntimeError: the port is in use, or the host is not this machine.
        """
        import foxglove

        logging.getLogger("foxglove").addHandler(
            logging.NullHandler()
        )  # otherwise printed on the terminal
        self._context = foxglove.Context()
        self._server = foxglove.start_server(
            name="fretc watch", host=host, port=port, context=self._context
        )
        self.host, self.port = host, self._server.port
        self._channels: dict[Channel, foxglove.Channel] = {}
        self._states: dict[str, foxglove.Channel] = {}

    def pass_on(self, arrival: Arrival) -> None:
        """Send a message of the robot, on a channel with the same encoding."""
        channel = self._channels.get(arrival.channel)
        if channel is None:
            channel = self._channels[arrival.channel] = self._opened(arrival.channel)
        channel.log(arrival.payload, log_time=arrival.log_time)

    def publish(self, states: Sequence[State], known: Sequence[Status], now: int) -> None:
        """The state of each requirement, on a channel of its own."""
        statuses = {each.name: each for each in known[1:]}
        for state in states:
            if state.requirement not in self._states:
                self._states[state.requirement] = self._opened(
                    Channel(
                        state_topic(state.requirement),
                        "json",
                        NAME,
                        "jsonschema",
                        json.dumps(SCHEMA).encode(),
                    )
                )
            content = json.dumps(message(state, statuses[state.requirement])).encode()
            self._states[state.requirement].log(content, log_time=now or None)

    def close(self) -> None:
        """Close the server."""
        self._server.stop()

    def _opened(self, channel: Channel) -> foxglove.Channel:
        import foxglove

        schema = foxglove.Schema(
            name=channel.schema_name, encoding=channel.schema_encoding, data=channel.schema
        )
        return foxglove.Channel(
            channel.topic,
            message_encoding=channel.message_encoding,
            schema=schema,
            context=self._context,
        )


def message(state: State, status: Status) -> dict[str, object]:
    """The message about a requirement; it fits `SCHEMA`."""
    times = {name: getattr(state, name) for name in _TIMES}
    return {
        "requirement": state.requirement,
        "level": LEVELS[status.level],
        "message": status.message,
        "verdict": state.verdict,
        "obligation_pending": _ANSWERS[state.obligation_pending],
        **{name: time for name, time in times.items() if time is not None},
    }


def opened(host: str, port: int) -> FoxgloveServer | Diagnostic:
    """The server, or the diagnostic that says why it cannot be started."""
    try:
        return FoxgloveServer(host, port)
    except ImportError as error:
        return diagnostic("no_foxglove_sdk", error=error, help=install_help("live"))
    except (RuntimeError, OverflowError) as error:
        why = str(error).rpartition(": ")[2]
        return diagnostic("no_foxglove_server", host=host, port=port, why=why)
