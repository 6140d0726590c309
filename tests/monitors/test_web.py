"""Web servers that do something else than send the log they are asked for."""

import asyncio
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from fretish.diagnostic import Code, Diagnostic
from monitors import inputs, web
from monitors.inputs import opened

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
    monkeypatch.setattr(inputs, "_PATIENCE", -1)
    monkeypatch.setattr(inputs, "_SLOWEST", 2**60)
    with opened(f"{server[0]}/good") as log:
        assert isinstance(log, Diagnostic)
        assert "next to nothing" in log.message


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
