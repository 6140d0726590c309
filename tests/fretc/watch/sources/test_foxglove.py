"""`fretc watch foxglove`: what it says is what an audit says, no matter who the server is."""

import json
import os
import signal
import socket
import ssl
import sys
from base64 import b64encode
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from websockets.sync.server import ServerConnection

from fretc.commands.watch_output import Lines
from fretc.watch.events import DiagnosticEvent
from fretc.watch.session import Session
from fretc.watch.sources import foxglove
from fretc.watch.sources.foxglove import Foxglove
from fretc.watch.sources.foxglove_protocol import address
from fretc.watch.sources.source import (
    Arrival,
    Channel,
    ConnectionLost,
    Opened,
    Problem,
    Reconnected,
)
from fretc.watch.watch import Watch
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc
from tests.each import each
from tests.foxglove import GREETING, Listened, advertisement, channel, hostile, listened, server
from tests.fretc.watch.sent import Setting, plan_of
from tests.fretc.watch.watched import Watched
from tests.ros1 import until

ROOT = Path(__file__).parents[4]
LOG = ROOT / "traces/mission-seed15.mcap"


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(foxglove, "PATIENCE", 3.0)
    monkeypatch.setattr(foxglove, "_PING", 0.05)


def only_problem(url: str) -> Diagnostic:
    """What is said of a server that was never there, and the end of it."""
    found = Listened(url)
    found.thread.join(20)
    assert not found.thread.is_alive()
    (item,) = found.items
    assert isinstance(item, Problem)
    assert item.diagnostic.code is Code.ROBOT_NOT_REACHED
    assert item.diagnostic.is_error
    return item.diagnostic


def sent(name: str, data: bytes, time: int = 7) -> dict[str, object]:
    return {"channel": name, "data": b64encode(data).decode(), "time": time}


def advertised(name: str, of: Channel) -> dict[str, object]:
    schema = [of.schema_name, of.schema_encoding, b64encode(of.schema).decode()]
    return {"channel": name, "topic": of.topic, "encoding": of.message_encoding, "schema": schema}


# A server by the SDK

CHANNELS = {
    "json": Channel("/json", "json", "T", "jsonschema", b'{"type": "object"}'),
    "cdr": Channel("/cdr", "cdr", "std_msgs/msg/Bool", "ros2msg", b"bool data\n"),
    "ros1": Channel("/ros1", "ros1", "std_msgs/Bool", "ros1msg", b"bool data\n"),
    "protobuf": Channel("/protobuf", "protobuf", "a.B", "protobuf", bytes(range(256))),
    "other": Channel("/other", "other", "O", "odd", "ö\n".encode()),
}


def test_channels_and_messages_are_those_that_were_sent() -> None:
    with server() as robot:
        for name, about in list(CHANNELS.items())[:3]:
            robot.ask("advertise", **advertised(name, about))
        with listened(robot.url, *(each.topic for each in CHANNELS.values())) as found:
            found.wait("it is opened", lambda: found.of(Opened))
            for name, about in list(CHANNELS.items())[3:]:
                robot.ask("advertise", **advertised(name, about))
            for i, name in enumerate(CHANNELS):
                _send_until_it_comes(robot, found, name, bytes([i, 0, 255]), 10**18 + i)
            robot.ask("withdraw", channel="cdr")
            found.wait("it is reported", lambda: Code.CHANNEL_REFUSED in found.codes)
            robot.ask("advertise", **advertised("again", CHANNELS["cdr"]))
            _send_until_it_comes(robot, found, "again", b"2", 5)
            robot.ask("time")
            found.wait("it is reported", lambda: Code.SIMULATED_TIME in found.codes)
    arrivals = found.of(Arrival)
    sent_by = {name: bytes([i, 0, 255]) for i, name in enumerate(CHANNELS)}
    for name, about in CHANNELS.items():
        assert {each.channel for each in arrivals if each.payload == sent_by[name]} == {about}
    assert {each.channel for each in arrivals if each.payload == b"2"} == {CHANNELS["cdr"]}
    times = [each.log_time for each in arrivals]
    assert times == sorted(times)
    assert not found.of(ConnectionLost)


def _send_until_it_comes(robot: Any, found: Listened, name: str, data: bytes, time: int) -> None:
    """A server that takes a subscription says nothing of it."""

    def came() -> bool:
        robot.ask("send", **sent(name, data, time))
        return any((a.payload, a.publish_time) == (data, time) for a in found.of(Arrival))

    found.wait(f"a message of {name} comes", came)


@pytest.mark.slow
def test_a_server_that_is_gone_is_sought_again() -> None:
    about = advertised("c", CHANNELS["json"])
    with server() as robot:
        robot.ask("advertise", **about)
        port = robot.port
        with listened(robot.url, "/json") as found:
            found.wait("it is opened", lambda: found.of(Opened))
            _send_until_it_comes(robot, found, "c", b"1", 1)
            last = found.of(Arrival)[-1].log_time
            robot.process.kill()
            found.wait("it is interrupted", lambda: found.of(ConnectionLost))
            with server(port) as other:
                other.ask("advertise", **about)
                found.wait("it is there again", lambda: found.of(Reconnected))
                _send_until_it_comes(other, found, "c", b"2", 2)
    lost, back = found.of(ConnectionLost)[0], found.of(Reconnected)[0]
    assert last < lost.since == back.since < back.until
    assert lost.problem.code is Code.ROBOT_NOT_REACHED


@pytest.mark.slow
def test_a_server_that_answers_no_more_is_gone() -> None:
    with server() as robot, listened(robot.url) as found:
        found.wait("it is opened", lambda: found.of(Opened))
        robot.process.send_signal(signal.SIGSTOP)
        found.wait("it is interrupted", lambda: found.of(ConnectionLost))
        robot.process.send_signal(signal.SIGCONT)
        found.wait("it is there again", lambda: found.of(Reconnected))
    assert "has not answered" in found.of(ConnectionLost)[0].problem.message


@pytest.mark.slow
def test_verdicts_of_a_running_robot_are_those_of_the_audit_of_the_recording(
    fretc: Fretc, tmp_path: Path
) -> None:
    """A part of a mission, in real time: a stop, and the robot that stands."""
    requirements = ["--requirements", str(ROOT / "requirements/r1.fret")]
    with server() as robot:
        words = ("--record", "run.mcap", "--evidence", "live.json")
        run = Watched(os.environ, tmp_path, "foxglove", robot.url, *requirements, *words)
        try:
            opened = {"type": "opened", "source": robot.url}
            until("it is opened", lambda: opened in run.lines, 30)
            robot.ask("play", part=[str(LOG), 5.0, 6.5])
            until("it was triggered", lambda: any(line.get("triggered_ns") for line in run.lines))
            status = run.end()
        finally:
            run.close()
    again = fretc("audit", "run.mcap", *requirements, "-o", "audit.json")
    assert again.status == status, (again.err, run.lines)
    assert (tmp_path / "audit.json").read_bytes() == (tmp_path / "live.json").read_bytes()
    (result,) = json.loads((tmp_path / "audit.json").read_text())["results"]
    assert run.verdicts() == {"R1": result["verdict"]}
    assert result["triggers"]


# Strangers


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def test_without_a_server_there_is_one_error() -> None:
    problem = only_problem(f"ws://user:secret@127.0.0.1:{free_port()}/path")
    assert "refused" in problem.message
    assert "secret" not in problem.message


@each("answer", [b"", b"\0" * 5000, b"HTTP/1.1 200 OK\r\n\r\n", b"SSH-2.0-x\r\n", None])
def test_what_is_no_websocket_server_is_one_error(answer: bytes | None) -> None:
    """None: it never answers."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def serve() -> None:
            taken, _ = listening.accept()
            with taken:
                taken.recv(1000)
                if answer is not None:
                    taken.sendall(answer)
                else:
                    done.join(20)

        url = f"ws://127.0.0.1:{listening.getsockname()[1]}"
        done = Thread(target=lambda: only_problem(url))
        serving = Thread(target=serve, daemon=True)
        serving.start()
        done.start()
        done.join(20)
        assert not done.is_alive()
        serving.join(20)


def silent(connection: ServerConnection) -> None:
    connection.recv()


def saying(*messages: str | bytes) -> Callable[[ServerConnection], None]:
    def handle(connection: ServerConnection) -> None:
        for message in messages:
            connection.send(message)
        while True:
            connection.recv()

    return handle


@each("subprotocols", [None, ["foxglove.websocket.v99"]])
def test_a_server_of_another_protocol_is_one_error(subprotocols: list[str] | None) -> None:
    with hostile(silent, subprotocols=subprotocols) as url:
        assert "Foxglove" in only_problem(url).message


@each("first", [None, "{}", '{"op": "status", "level": 0, "message": ""}', b"\x01", "no json"])
def test_a_server_that_does_not_greet_is_one_error(first: str | bytes | None) -> None:
    with hostile(silent if first is None else saying(first)) as url:
        only_problem(url)


SENT_TO_US = b"\x01" + (1).to_bytes(4, "little") + (9).to_bytes(8, "little")
WELL = saying(GREETING, advertisement(channel(4)), SENT_TO_US + b'{"data": 1}')


def closes(connection: ServerConnection) -> None:
    connection.send(GREETING)
    connection.close(1011, "\x1b[2J out of order")


@pytest.mark.slow
@each(
    "handler",
    [
        closes,
        saying(GREETING, "no json"),
        saying(GREETING, '{"op": "advertise", "channels": [{"topic": "/x"}]}'),
        saying(GREETING, b"\x01\0"),
        saying(GREETING, b""),
        saying(GREETING, b"\x03" + bytes(2**16)),
    ],
)
def test_a_server_that_misbehaves_is_left_and_sought_again(
    handler: Callable[[ServerConnection], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foxglove, "LARGEST", 2**15)
    with hostile(handler, WELL) as url, listened(url) as found:
        found.wait("it is there again", lambda: found.of(Arrival) and found.of(Reconnected))
    kinds = [type(item) for item in found.items if not isinstance(item, Arrival)]
    assert kinds == [Opened, ConnectionLost, Reconnected]
    (lost,), (back,) = found.of(ConnectionLost), found.of(Reconnected)
    assert lost.since == back.since < back.until
    assert lost.problem.code is Code.ROBOT_NOT_REACHED


def test_one_that_says_too_much_is_heard_up_to_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(foxglove, "MOST_CHANNELS", 3)
    words = [json.dumps({"op": "status", "level": 2, "message": f"\x1b{i}"}) for i in range(50)]
    channels = [channel(i, schemaName=f"T{i}") for i in range(40)]
    same = [channel(i) for i in range(100, 140)]
    talker = saying(GREETING, *words, advertisement(*channels, *same), SENT_TO_US)
    with hostile(talker) as url, listened(url) as found:
        found.wait("the message comes", lambda: found.of(Arrival))
    codes = found.codes
    assert codes.count(Code.SERVER_STATUS) == foxglove.MOST_STATUSES + 1
    assert codes.count(Code.CHANNEL_REFUSED) == 1
    assert codes.count(Code.SEVERAL_PUBLISHERS) == 1


def test_nothing_of_a_stranger_reaches_the_terminal_as_it_is(
    capsys: pytest.CaptureFixture[str],
) -> None:
    word = json.dumps({"op": "status", "level": 2, "message": "\x1b[2J\x07"})
    with hostile(saying(GREETING, word), closes) as url, listened(url) as found:
        found.wait("it is reported", lambda: found.codes)
    plan = plan_of(Setting(slow="y < 5"))
    lines = Lines()
    for problem in found.of(Problem):
        lines.tell(DiagnosticEvent(problem.diagnostic), Session(plan))
    with hostile(closes) as url, listened(url) as found:
        found.wait("it is reported", lambda: found.of(ConnectionLost))
    for event in found.of(ConnectionLost):
        lines.tell(event, Session(plan))
    output = capsys.readouterr()
    assert "out of order" in output.out
    assert "the server reports" in output.err
    assert not {"\x1b", "\x07"} & {*output.out, *output.err}


def test_a_channel_that_becomes_another_one_is_subscribed_anew() -> None:
    requests: list[dict[str, Any]] = []

    def change(connection: ServerConnection) -> None:
        connection.send(GREETING)
        for name in ("A", "A", "B"):
            connection.send(advertisement(channel(1, schemaName=name)))
        while len(requests) < 3:
            requests.append(json.loads(connection.recv()))
        for i in (1, 2):
            connection.send(b"\x01" + i.to_bytes(4, "little") + bytes(8))
        silent(connection)

    with hostile(change) as url, listened(url) as found:
        found.wait("the message comes", lambda: found.of(Arrival))
    assert [request["op"] for request in requests] == ["subscribe", "unsubscribe", "subscribe"]
    assert requests[1]["subscriptionIds"] == [1]
    assert [each.channel.schema_name for each in found.of(Arrival)] == ["B"]


def test_a_channel_that_the_server_does_not_know_yet_is_asked_for_again() -> None:
    """The SDK advertises a channel a moment before it takes subscriptions to it."""
    requests: list[dict[str, Any]] = []
    unknown = json.dumps({"op": "status", "level": 2, "message": "Unknown channel ID: 44"})

    def late(connection: ServerConnection) -> None:
        connection.send(GREETING)
        connection.send(advertisement(channel(44)))
        for _ in range(3):
            requests.append(json.loads(connection.recv()))
            connection.send(unknown)
        requests.append(json.loads(connection.recv()))
        connection.send(SENT_TO_US)
        connection.send(unknown)
        silent(connection)

    with hostile(late) as url, listened(url) as found:
        found.wait("the message comes", lambda: found.of(Arrival))
        found.wait("now it is reported", lambda: found.codes)
    assert len(requests) == 4
    assert all(request == requests[0] for request in requests)
    assert found.codes == [Code.SERVER_STATUS]


@pytest.mark.slow
@each("encoding", ["odd", "cdr", "protobuf", "ros1"])
def test_a_channel_that_cannot_be_decoded_is_told_of(encoding: str) -> None:
    """With the message, for without one nothing is missing."""
    about = channel(1, encoding=encoding, schema="bm90IG9uZQ==", schemaEncoding=None)
    with hostile(saying(GREETING, advertisement(about), SENT_TO_US)) as url, listened(url) as found:
        found.wait("the message comes", lambda: found.of(Arrival))
    watch = Watch(plan_of(Setting(slow="y < 5")))
    news = [each for item in found.items for each in watch.take(item)]
    problems = [each.diagnostic.code for each in news if isinstance(each, DiagnosticEvent)]
    assert Code.UNKNOWN_ENCODING in problems


def test_a_certificate_has_to_be_trusted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = certificate(tmp_path)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*files)
    # A server for each client: the library's server ends where a client that does not trust it, or
    # one without TLS, has gone before it is accepted (`SSLError: Closed before TLS handshake`).
    monkeypatch.setattr(foxglove, "PATIENCE", 15.0)
    with hostile(WELL, ssl=context) as url:
        assert "certificate" in only_problem(url).message
    with hostile(WELL, ssl=context) as url:
        assert "TLS" not in only_problem(url.replace("wss", "ws")).message
    monkeypatch.setenv("SSL_CERT_FILE", str(files[0]))
    with hostile(WELL, ssl=context) as url, listened(url) as found:
        found.wait("the message comes", lambda: found.of(Arrival))
    with hostile(WELL) as url:
        assert "TLS" in only_problem(url.replace("ws", "wss")).message


def certificate(folder: Path) -> tuple[Path, Path]:
    """A certificate of 127.0.0.1 that has signed itself, and its key."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "robot")])
    now = datetime.now(UTC)
    made = (
        x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=1))
        .add_extension(
            x509.SubjectAlternativeName([x509.IPAddress(ip_address("127.0.0.1"))]), critical=False
        )
        .sign(key, hashes.SHA256())
    )
    paths = folder / "certificate.pem", folder / "key.pem"
    paths[0].write_bytes(made.public_bytes(serialization.Encoding.PEM))
    paths[1].write_bytes(
        key.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.NoEncryption(),
        )
    )
    return paths


# Words


@each(
    "url",
    [
        "", "robot:8765", "http://robot", "ws://", "ws://r:x", "ws://r:0", "ws://r/\x1b",
        "ws://[", "ws://r/#a",
    ],
)  # fmt: skip
def test_what_is_no_url_is_bad_usage(url: str) -> None:
    found = address(url)
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_USAGE


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "websockets.sync.client", None)
    parts = address("ws://127.0.0.1:1")
    assert not isinstance(parts, Diagnostic)
    (problem,) = Foxglove(parts).arrivals(["/x"])
    assert isinstance(problem, Problem)
    assert problem.diagnostic.code is Code.MISSING_EXTRA
    assert "fretc[live]" in (problem.diagnostic.help or "")
