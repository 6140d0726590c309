"""The endpoint: a WebSocket server in a thread of its own."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Mapping
from threading import Event, Thread
from types import TracebackType
from typing import TYPE_CHECKING, Any

from fretc.rosbridge.encoding import as_cbor, as_json
from fretc.rosbridge.session import NO_SERVICES, Graph, Service, Session
from fretc.rosbridge.subscriptions import fragments

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

LARGEST = 2**22
"""The most bytes of a client's message."""
MOST_CLIENTS = 16
_MOST_REPLIES = 256
_PATIENCE = 10.0
"""Seconds for the server to start and to end."""


class Endpoint:
    """A running endpoint; leaving its context ends it."""

    def __init__(
        self,
        types: Mapping[str, str],
        receive: Callable[[str, str, Any], None],
        host: str = "127.0.0.1",
        port: int = 0,
        services: Mapping[str, Service] = NO_SERVICES,
    ) -> None:
        """Start to listen.

        Args:
            types: topic → type, such as `std_msgs/Bool`, of the topics that exist.
            receive: takes topic, type and message of a client, in the endpoint's thread. A
                ValueError says that the message does not conform to the type.
            host: the address to listen on.
            port: the port; 0: any free one.
            services: name → what answers a call, in the endpoint's thread.

        Raises:
            OSError: the address cannot be used.
            ModuleNotFoundError: websockets is not installed.
        """
        self._graph = Graph(types, receive, services)
        self._host, self._port = host, port
        self._clients: set[_Client] = set()
        self._failure: BaseException | None = None
        self._started = Event()
        self._loop = asyncio.new_event_loop()
        self._end = asyncio.Event()
        self._thread = Thread(target=self._run, name="rosbridge", daemon=True)
        self._thread.start()
        self._started.wait(_PATIENCE)
        if self._failure is not None:
            raise self._failure

    @property
    def url(self) -> str:
        """The address for clients."""
        return f"ws://{self._host}:{self._port}"

    @property
    def port(self) -> int:
        """The port on which it listens, or has listened."""
        return self._port

    @property
    def clients(self) -> int:
        """The number of clients."""
        return len(self._clients)

    def subscribers(self, topic: str) -> int:
        """The number of clients that have subscribed to a topic."""
        return sum(topic in client.session.queues for client in tuple(self._clients))

    def publish(self, topic: str, message: Any) -> None:
        """Send a message of a topic to its subscribers; never waits."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._put, topic, message)

    def _put(self, topic: str, message: Any) -> None:
        for client in self._clients:
            client.put(topic, message)

    def __enter__(self) -> Endpoint:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End all connections, and stop to listen."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._end.set)
            self._thread.join(_PATIENCE)

    def _run(self) -> None:
        try:
            self._loop.run_until_complete(self._serve())
        except BaseException as error:  # it is raised in the thread that started this one
            self._failure = error
        finally:
            self._started.set()
            self._loop.close()

    async def _serve(self) -> None:
        from websockets.asyncio.server import serve

        logger = logging.getLogger("fretc.rosbridge")
        logger.addHandler(logging.NullHandler())
        logger.propagate = False
        async with serve(
            self._handle, self._host, self._port, max_size=LARGEST, logger=logger, close_timeout=1
        ) as server:
            self._port = next(iter(server.sockets)).getsockname()[1]
            self._started.set()
            await self._end.wait()

    async def _handle(self, connection: ServerConnection) -> None:
        from websockets.exceptions import ConnectionClosed

        if len(self._clients) >= MOST_CLIENTS:
            await connection.close(1013, "too many clients")
            return
        client = _Client(self._graph)
        self._clients.add(client)
        sender = asyncio.create_task(client.send(connection))
        try:
            async for text in connection:
                client.session.receive(text)
                client.awake.set()
        except ConnectionClosed:
            pass
        finally:
            self._clients.discard(client)
            client.session.close()
            sender.cancel()


class _Client:
    """A connected client, and what it gets."""

    def __init__(self, graph: Graph) -> None:
        self._replies: deque[dict[str, Any]] = deque(maxlen=_MOST_REPLIES)
        self.session = Session(graph, self._replies.append)
        self.awake = asyncio.Event()
        self._count = self._fragmented = 0

    def put(self, topic: str, message: Any) -> None:
        queue = self.session.queues.get(topic)
        if queue is not None:
            self._count += 1
            queue.put(self._count, message, asyncio.get_running_loop().time())
            self.awake.set()

    async def send(self, connection: ServerConnection) -> None:
        """Send what is due, until the connection ends."""
        from websockets.exceptions import ConnectionClosed

        loop = asyncio.get_running_loop()
        try:
            while True:
                self.awake.clear()
                while self._replies:
                    await connection.send(as_json(self._replies.popleft()))
                while (topic := self._next(loop.time())) is not None:
                    await self._send_topic(connection, topic, loop.time())
                due = min((q.due() for q in self.session.queues.values()), default=float("inf"))
                wait = None if due == float("inf") else max(0.0, due - loop.time())
                try:
                    await asyncio.wait_for(self.awake.wait(), wait)
                except TimeoutError:
                    continue
        except ConnectionClosed:
            return

    def _next(self, now: float) -> str | None:
        """The topic of the earliest message that may be sent."""
        due = [
            (q.waiting[0][0], topic) for topic, q in self.session.queues.items() if q.due() <= now
        ]
        return min(due)[1] if due else None

    async def _send_topic(self, connection: ServerConnection, topic: str, now: float) -> None:
        queue = self.session.queues[topic]
        options = queue.merged
        operation = {"op": "publish", "topic": topic, "msg": queue.take(now)}
        if options.compression == "cbor":
            await connection.send(as_cbor(operation))
            return
        text = as_json(operation)
        if options.fragment is None or len(text) <= options.fragment:
            await connection.send(text)
            return
        self._fragmented += 1
        for part in fragments(text, options.fragment, str(self._fragmented)):
            await connection.send(as_json(part))
