"""Web servers that do something else than send the log they are asked for."""

import asyncio
import socketserver
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import count, pairwise
from types import SimpleNamespace
from typing import Any

import fsspec
import pytest

from fretc.logs.storage import inputs, web
from fretc.logs.storage.inputs import opened
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import by_turns

LENGTH = 5 * 2**20


class Server(BaseHTTPRequestHandler):
    """Each path is a way to misbehave."""

    asked: list[tuple[str, str]]

    def do_HEAD(self) -> None:
        self.send_response(200)
        self.send_header("Accept-Ranges", "bytes")
        if self.path != "/endless-whole":
            self.send_header("Content-Length", str(LENGTH))
        self.end_headers()

    def do_GET(self) -> None:
        self.asked.append((self.path, self.headers.get("Range", "")))
        match self.path:
            case "/elsewhere":
                self.send_response(302)
                self.send_header("Location", "ftp://127.0.0.1/a.mcap")
                self.end_headers()
            case "/endless-part":
                self.send_response(206)
                self.send_header("Content-Range", f"bytes 0-9/{LENGTH}")
                self.end_headers()
                self._endless()
            case "/more":
                self.send_response(206)
                self.send_header("Content-Length", str(2 * LENGTH))
                self.end_headers()
                self._endless()
            case "/endless-whole":
                self.send_response(200)
                self.end_headers()
                self._endless()
            case "/good":
                first, _, last = self.headers["Range"].removeprefix("bytes=").partition("-")
                self.send_response(206)
                self.send_header("Content-Length", str(int(last) - int(first) + 1))
                self.end_headers()
                self.wfile.write(b"x" * (int(last) - int(first) + 1))

    def _endless(self) -> None:
        end = time.monotonic() + 5
        while time.monotonic() < end:
            try:
                self.wfile.write(b"x" * 2**16)
            except OSError:
                return

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def server() -> Iterator[tuple[str, list[tuple[str, str]]]]:
    asked: list[tuple[str, str]] = []
    running = ThreadingHTTPServer(("127.0.0.1", 0), type("One", (Server,), {"asked": asked}))
    thread = threading.Thread(target=running.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{running.server_port}", asked
    running.shutdown()
    thread.join()
    running.server_close()


@pytest.mark.parametrize("path", ["/elsewhere", "/endless-part", "/more", "/endless-whole"])
def test_a_server_that_sends_something_else_is_told_at_once(
    server: tuple[str, Any], monkeypatch: pytest.MonkeyPatch, path: str
) -> None:
    monkeypatch.setattr(inputs, "_MOST", 2**24)
    since = time.monotonic()
    with opened(f"{server[0]}{path}") as log:
        assert isinstance(log, Diagnostic)
        assert log.code is Code.UNREADABLE
    assert time.monotonic() - since < 4


def test_a_server_that_sends_next_to_nothing_is_not_waited_for(
    server: tuple[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = count(step=100)
    monkeypatch.setattr(inputs, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    monkeypatch.setattr(web, "SLOWEST", 2**60)
    with opened(f"{server[0]}/good") as log:
        assert isinstance(log, Diagnostic)
        assert "hardly any data" in log.message


# Answers that have no end


class Endless(socketserver.StreamRequestHandler):
    """Each path is an answer that goes on until the client leaves."""

    server: "Forever"

    def handle(self) -> None:
        asked, path = self.rfile.readline().decode().split(" ")[:2]
        while self.rfile.readline().strip():
            pass
        with suppress(OSError):
            for piece in ANSWERS[path.partition("?")[0].removeprefix("/")](asked):
                self.wfile.write(piece)
                if len(piece) < 10:
                    self.server.left.wait(0.02)
                if self.server.left.is_set():
                    return
            self.server.left.wait()


class Forever(socketserver.ThreadingTCPServer):
    """It ends where the test does."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Endless)
        self.left = threading.Event()


OK = b"HTTP/1.1 200 OK\r\n"
SIZED = OK + b"Accept-Ranges: bytes\r\nContent-Length: 5000000\r\n\r\n"
PART = b"HTTP/1.1 206 Partial Content\r\nContent-Length: 4194304\r\n\r\n"
CHUNKED = OK + b"Transfer-Encoding: chunked\r\n\r\n"
Answer = Callable[[str], Iterator[bytes]]


def answer(head: bytes, piece: bytes = b"", first: bytes = OK + b"\r\n") -> Answer:
    """To the question for the size, the first; to any other one, the head and pieces for ever."""

    def pieces(asked: str) -> Iterator[bytes]:
        yield first if asked == "HEAD" else head
        while piece and asked != "HEAD":
            yield piece

    return pieces


def trickled(head: bytes) -> Answer:
    """Even the size: a byte now and then."""

    def pieces(_: str) -> Iterator[bytes]:
        yield head
        while True:
            yield b"x"

    return pieces


HOP = b"HTTP/1.1 302 Found\r\nContent-Length: 0\r\nLocation: /hops?again\r\n\r\n"
ANSWERS: dict[str, Answer] = {
    "nothing": lambda _: iter(()),
    "nothing-after-the-size": answer(b"", first=SIZED),
    "nothing-of-a-part": answer(PART, first=SIZED),
    "nothing-of-all": answer(OK + b"\r\n"),
    "a-line-without-an-end": trickled(b"HTTP/1.1 200 "),
    "a-header-without-an-end": trickled(OK + b"X: "),
    "headers": trickled(OK),
    "interim-answers": answer(b"", b"HTTP/1.1 100 Continue\r\n\r\n", first=SIZED),
    "interim-answers-to-all": answer(b"", b"HTTP/1.1 100 Continue\r\n\r\n"),
    "hops": answer(HOP, first=HOP),
    "a-part-in-bytes": answer(PART, b"x", first=SIZED),
    "all-in-bytes": answer(OK + b"\r\n", b"x"),
    "chunks-of-a-byte": answer(CHUNKED, b"1\r\nx\r\n"),
    "a-chunk-with-a-long-header": answer(CHUNKED + b"1;", b"x"),
    "trailers": answer(CHUNKED + b"1\r\nx\r\n0\r\nT: ", b"x"),
    "a-size-beyond-any-disk": answer(b"", first=SIZED.replace(b"5000000", b"5000000000000000000")),
    "a-negative-size": answer(b"", first=SIZED.replace(b"5000000", b"-1")),
    "chunks-of-a-part-that-has-a-size": answer(
        PART[:-2] + b"Transfer-Encoding: chunked\r\n\r\n", b"1\r\nx\r\n", first=SIZED
    ),
}


@pytest.fixture
def endless(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    monkeypatch.setattr(web, "PATIENCE", 0.3)
    monkeypatch.setattr(web, "SLOWEST", 2**60)
    fsspec.filesystem("http").clear_instance_cache()
    running = Forever()
    thread = threading.Thread(target=running.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield f"http://127.0.0.1:{running.server_address[1]}"
    running.left.set()
    running.shutdown()
    thread.join()
    running.server_close()
    fsspec.filesystem("http").clear_instance_cache()


@pytest.mark.slow
@pytest.mark.parametrize(("path", "whole"), by_turns(ANSWERS, True, False))
def test_reading_ends_whatever_a_server_sends_for_ever(
    endless: str, path: str, whole: bool
) -> None:
    with opened(f"{endless}/{path}", whole=whole) as log:
        if isinstance(log, Diagnostic):
            assert log.code is Code.UNREADABLE
            return
        with pytest.raises(OSError, match=r"hardly any data|another byte range|HTTP"):
            log.stream.read()


def test_no_byte_is_asked_for_twice_so_that_what_is_judged_is_what_is_hashed(
    server: tuple[str, list[tuple[str, str]]],
) -> None:
    with opened(f"{server[0]}/good") as log:
        assert not isinstance(log, Diagnostic)
        assert (log.size, len(log.stream.read())) == (LENGTH, LENGTH)
        log.stream.seek(17)
        log.stream.read(2**20)
        log.sha256()
    parts = sorted(tuple(map(int, part.removeprefix("bytes=").split("-"))) for _, part in server[1])
    assert all(before[1] < after[0] for before, after in pairwise(parts))


@pytest.mark.parametrize(
    ("scheme", "place", "followed"),
    [
        ("https", "https://other/a.mcap", True),
        ("https", "/b.mcap", True),
        ("https", "http://host/a.mcap", False),
        ("https", "file:///etc/passwd", False),
        ("http", "http://other/a.mcap", True),
        ("http", "https://other/a.mcap", True),
        ("http", "ftp://other/a.mcap", False),
    ],
)
def test_from_https_only_https_is_reached(scheme: str, place: str, followed: bool) -> None:
    request = SimpleNamespace(
        response=SimpleNamespace(headers={"Location": place}), url=SimpleNamespace(scheme=scheme)
    )
    check = web._redirects(scheme)
    if followed:
        asyncio.run(check(None, None, request))
    else:
        with pytest.raises(OSError, match="another protocol"):
            asyncio.run(check(None, None, request))


def test_the_session_of_an_https_url_is_the_strict_one() -> None:
    assert web.options("https://host/a")["get_client"] is web._only_safe
    assert web.options("HTTPS://host/a")["get_client"] is web._only_safe
    assert web.options("http://host/a")["get_client"] is web._any
    assert web.options("s3://bucket/a") == {}
