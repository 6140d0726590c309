"""Foxglove servers for tests: one by the SDK, in a process of its own, and hostile ones.

Anyone who waits, waits for what a server or a client says, never for a time to pass.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from ssl import SSLContext
from threading import Thread
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from fretc.watch.sources.foxglove import Foxglove
from fretc.watch.sources.foxglove_protocol import address
from fretish.diagnostics.diagnostic import Diagnostic
from tests.source_listener import SourceListener, closed

_SERVER = '''
"""Serves what standard input says: an object of JSON a line. It prints each line that is done."""
import base64, json, sys, time
import foxglove
from foxglove import Channel, Context, Schema
from foxglove.websocket import Capability

foxglove.set_log_level("ERROR")
context = Context()
server = foxglove.start_server(
    host="127.0.0.1", port=int(sys.argv[1]), context=context, capabilities=[Capability.Time]
)
print(server.port, flush=True)
channels = {}

def play(path, start, end):
    """A part of a log, as it went, in seconds from its beginning."""
    from mcap.reader import make_reader
    own, begin, first = {}, None, None
    with open(path, "rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            first = first or message.log_time
            at = (message.log_time - first) / 1e9
            if not start <= at < end:
                continue
            if channel.topic not in own:
                kind = Schema(name=schema.name, encoding=schema.encoding, data=schema.data)
                own[channel.topic] = Channel(
                    channel.topic, message_encoding=channel.message_encoding, schema=kind,
                    context=context,
                )
            begin = begin or time.monotonic() - at
            time.sleep(max(0, begin + at - time.monotonic()))
            own[channel.topic].log(message.data, log_time=message.log_time)

for line in sys.stdin:
    asked = json.loads(line)
    name = asked.get("channel")
    match asked["do"]:
        case "advertise":
            schema = asked["schema"] and Schema(
                name=asked["schema"][0], encoding=asked["schema"][1],
                data=base64.b64decode(asked["schema"][2]),
            )
            channels[name] = Channel(
                asked["topic"], message_encoding=asked["encoding"], schema=schema, context=context
            )
        case "send":
            channels[name].log(base64.b64decode(asked["data"]), log_time=asked["time"])
        case "withdraw":
            channels.pop(name).close()
        case "time":
            server.broadcast_time(1)
        case "play":
            play(*asked["part"])
    print(json.dumps(asked), flush=True)
'''


@dataclass
class Server:
    """A server by the SDK; what it is asked to do is done when the call returns."""

    process: subprocess.Popen[str]
    port: int

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}"

    def ask(self, do: str, **more: object) -> None:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps({"do": do, **more}), file=self.process.stdin, flush=True)
        assert json.loads(self.process.stdout.readline())["do"] == do


@contextmanager
def server(port: int = 0) -> Iterator[Server]:
    """A server on a port that is free, or on this one."""
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", _SERVER, str(port)], **pipes)
    try:
        assert process.stdout is not None
        yield Server(process, int(process.stdout.readline()))
    finally:
        process.kill()
        process.communicate()


GREETING = json.dumps({"op": "serverInfo", "name": "", "capabilities": []})


def advertisement(*channels: dict[str, object]) -> str:
    return json.dumps({"op": "advertise", "channels": channels})


def channel(id: int, topic: str = "/x", **more: object) -> dict[str, object]:
    usual = {"encoding": "json", "schemaName": "", "schema": "", "schemaEncoding": "jsonschema"}
    return {"id": id, "topic": topic, **usual, **more}


@contextmanager
def hostile(
    *handlers: Callable[[ServerConnection], None],
    subprotocols: Sequence[str] | None = ("foxglove.websocket.v1",),
    ssl: SSLContext | None = None,
) -> Iterator[str]:
    """The URL of a server that handles its first connections so; later ones as the last."""
    waiting = [*handlers]

    def handle(connection: ServerConnection) -> None:
        handler = waiting.pop(0) if len(waiting) > 1 else waiting[0]
        with suppress(ConnectionClosed):
            handler(connection)

    names = None if subprotocols is None else [Subprotocol(name) for name in subprotocols]
    with serve(handle, "127.0.0.1", 0, subprotocols=names, ssl=ssl, compression=None) as served:
        thread = Thread(target=served.serve_forever, daemon=True)
        thread.start()
        yield f"{'wss' if ssl else 'ws'}://127.0.0.1:{served.socket.getsockname()[1]}"
        served.shutdown()
        thread.join(5)


class Listened(SourceListener):
    """A source, and what it has given."""

    def __init__(self, url: str, *topics: str) -> None:
        parts = address(url)
        assert not isinstance(parts, Diagnostic), parts
        super().__init__(Foxglove(parts), *topics)


def listened(url: str, *topics: str) -> AbstractContextManager[Listened]:
    return closed(Listened(url, *topics))
