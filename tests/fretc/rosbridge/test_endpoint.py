"""The endpoint with a real client, roslibpy, and with hostile ones."""

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from queue import Queue
from typing import Any

import pytest

from fretc.rosbridge.endpoint import LARGEST, MOST_CLIENTS, Endpoint
from tests.programs import package

WAIT = 20.0
"""Seconds after which a test fails."""
TYPES = {"/chat": "std_msgs/String", "/scan": "sensor_msgs/LaserScan"}
ROSLIBPY = """
import sys, threading
import roslibpy

client = roslibpy.Ros(host="127.0.0.1", port=int(sys.argv[1]))
client.run(timeout=20)
heard, done = [], threading.Event()

def hear(message):
    heard.append(message["data"])
    if message["data"] == "end":
        done.set()

chat = roslibpy.Topic(client, "/chat", "std_msgs/String")
chat.subscribe(hear)
stop = roslibpy.Topic(client, "/stop", "std_msgs/Bool")
stop.advertise()
stop.publish(roslibpy.Message({"data": True}))
stop.publish(roslibpy.Message({"data": False}))
print("done" if done.wait(20) else "lost", heard)
chat.unsubscribe()
stop.unadvertise()
service = roslibpy.Service(client, "/double", "a_srvs/Double")
print("answer", service.call(roslibpy.ServiceRequest({"a": 21}), timeout=20)["a"])
try:
    service = roslibpy.Service(client, "/none", "std_srvs/Empty")
    print("answer", service.call(roslibpy.ServiceRequest({}), timeout=20))
except Exception as error:
    print("no service:", error)
client.terminate()
"""


@contextmanager
def running(received: "Queue[Any]") -> Iterator[Endpoint]:
    services = {"/double": lambda request: {"a": 2 * request["a"]}}
    with Endpoint(TYPES, lambda *message: received.put(message), services=services) as endpoint:
        yield endpoint


def until(true: Any) -> None:
    """Wait for a condition."""
    import time

    end = time.monotonic() + WAIT
    while not true():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.mark.slow
def test_roslibpy_publishes_subscribes_and_calls() -> None:
    package("roslibpy")
    received: Queue[Any] = Queue()
    with running(received) as endpoint:
        port = endpoint.url.rpartition(":")[2]
        client = subprocess.Popen(
            [sys.executable, "-c", ROSLIBPY, port], stdout=subprocess.PIPE, text=True
        )
        assert received.get(timeout=WAIT) == ("/stop", "std_msgs/Bool", {"data": True})
        assert received.get(timeout=WAIT) == ("/stop", "std_msgs/Bool", {"data": False})
        until(lambda: endpoint.subscribers("/chat"))
        texts = ["one", "two \xe9\u2028", "end"]
        for text in texts:
            endpoint.publish("/chat", {"data": text})
        out, _ = client.communicate(timeout=2 * WAIT)
    assert out.splitlines() == [
        f"done {texts}",
        "answer 42",
        "no service: service '/none' does not exist",
    ]
    assert client.returncode == 0


def connected(endpoint: Endpoint) -> Any:
    from websockets.sync.client import connect

    return connect(endpoint.url, open_timeout=WAIT, max_size=None)


def test_a_client_gets_the_messages_of_its_topics_and_no_others() -> None:
    received: Queue[Any] = Queue()
    with running(received) as endpoint, connected(endpoint) as client:
        client.send(json.dumps({"op": "subscribe", "topic": "/chat"}))
        until(lambda: endpoint.subscribers("/chat"))
        endpoint.publish("/scan", {"ranges": []})
        endpoint.publish("/chat", {"data": "hello"})
        assert json.loads(client.recv(timeout=WAIT)) == {
            "op": "publish",
            "topic": "/chat",
            "msg": {"data": "hello"},
        }


def test_cbor_and_fragments_are_sent_to_who_asks_for_them() -> None:
    received: Queue[Any] = Queue()
    with running(received) as endpoint, connected(endpoint) as one, connected(endpoint) as other:
        one.send(json.dumps({"op": "subscribe", "topic": "/chat", "compression": "cbor"}))
        other.send(json.dumps({"op": "subscribe", "topic": "/chat", "fragment_size": 20}))
        until(lambda: endpoint.subscribers("/chat") == 2)
        endpoint.publish("/chat", {"data": "x" * 40})
        message = {"op": "publish", "topic": "/chat", "msg": {"data": "x" * 40}}
        data = one.recv(timeout=WAIT)
        assert isinstance(data, bytes)
        assert data.startswith(b"\xa3\x62op\x67publish")
        parts = [json.loads(other.recv(timeout=WAIT))]
        parts += [json.loads(other.recv(timeout=WAIT)) for _ in range(parts[0]["total"] - 1)]
        assert json.loads("".join(part["data"] for part in parts)) == message


@pytest.mark.slow
def test_what_hostile_clients_send_disturbs_nobody() -> None:
    from websockets.exceptions import ConnectionClosed

    received: Queue[Any] = Queue()
    with running(received) as endpoint:
        with connected(endpoint) as client, connected(endpoint) as hostile:
            client.send(json.dumps({"op": "subscribe", "topic": "/chat"}))
            until(lambda: endpoint.subscribers("/chat"))
            for text in ("{", "null", "[" * 10_000, b"\x00\xff", '{"op": 1, "id": 2}'):
                hostile.send(text)
                assert json.loads(hostile.recv(timeout=WAIT))["level"] == "error"
            hostile.send("x" * (LARGEST + 1))
            with pytest.raises(ConnectionClosed):
                hostile.recv(timeout=WAIT)
            endpoint.publish("/chat", {"data": "still"})
            assert "still" in client.recv(timeout=WAIT)
        until(lambda: endpoint.clients == 0)
        with ExitStack() as many:
            for _ in range(MOST_CLIENTS):
                many.enter_context(connected(endpoint))
            until(lambda: endpoint.clients == MOST_CLIENTS)
            with pytest.raises(ConnectionClosed), connected(endpoint) as further:
                further.recv(timeout=WAIT)


@pytest.mark.slow
def test_a_client_that_does_not_read_keeps_nobody_waiting() -> None:
    received: Queue[Any] = Queue()
    with running(received) as endpoint, connected(endpoint) as lazy, connected(endpoint) as client:
        for each in (lazy, client):
            options = {"queue_length": 1}
            each.send(json.dumps({"op": "subscribe", "topic": "/chat", **options}))
        until(lambda: endpoint.subscribers("/chat") == 2)
        for number in range(300):
            endpoint.publish("/chat", {"data": f"{number}:{'x' * 100_000}"})
        last = ""
        while not last.startswith("299:"):
            last = json.loads(client.recv(timeout=WAIT))["msg"]["data"]


def test_an_address_that_is_taken_is_an_error() -> None:
    received: Queue[Any] = Queue()
    with running(received) as endpoint, pytest.raises(OSError, match="address already in use"):
        Endpoint({}, print, port=int(endpoint.url.rpartition(":")[2]))
