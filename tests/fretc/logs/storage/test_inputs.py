"""Logs that are no files: standard input in a process of its own, URLs of memory and servers."""

import hashlib
import io
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, ClassVar

import fsspec
import pytest

from fretc.logs import containers
from fretc.logs.mcap import contents
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretc.logs.storage import inputs
from fretc.logs.storage.inputs import opened
from fretc.logs.storage.log_names import is_url, name_of
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.rendering import render
from tests.command import Fretc
from tests.fretc.logs.logs import NONE, TWELVE, S, Sent, X, damaged, number, values, write

ROOT = Path(__file__).parents[4]


# Standard input


def info(stdin: Any, *arguments: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """`fretc info -` in a process of its own; no run shows a traceback."""
    found = subprocess.run(
        [sys.executable, "-c", "from fretc.cli import main; main()", "info", "-", *arguments],
        stdin=stdin,
        capture_output=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        timeout=60,
        check=False,
    )
    assert b"Traceback" not in found.stderr
    assert b"F999" not in found.stderr
    return found


@contextmanager
def piped(data: bytes) -> Iterator[int]:
    """The reading end of a pipe that gives the data."""
    reading, writing = os.pipe()

    def fill() -> None:
        with suppress(BrokenPipeError), open(writing, "wb") as stream:
            stream.write(data)

    thread = threading.Thread(target=fill)
    thread.start()
    try:
        yield reading
    finally:
        os.close(reading)
        thread.join()


@contextmanager
def standard_input(file: int) -> Iterator[None]:
    """A file as the standard input of this process."""
    before = os.dup(0)
    os.dup2(file, 0)
    try:
        with pytest.MonkeyPatch.context() as patch, open(0, closefd=False) as stdin:
            patch.setattr(sys, "stdin", stdin)
            yield
    finally:
        os.dup2(before, 0)
        os.close(before)


def shown(data: bytes) -> list[str]:
    """What `fretc info -` prints of such a log, but for its topics."""
    sha256 = hashlib.sha256(data).hexdigest()
    return [f"<stdin>  {len(data):,} bytes, 1.1 s, no damage found", f"  SHA-256  {sha256}"]


@pytest.mark.slow
def test_a_log_from_a_pipe_is_the_log(tmp_path: Path) -> None:
    data = write(tmp_path / "log.mcap", TWELVE).read_bytes()
    with piped(data) as stdin:
        found = info(stdin)
    assert (found.returncode, found.stderr) == (0, b"")
    assert found.stdout.decode().splitlines()[0:3:2] == shown(data)


def test_a_log_from_a_file_is_the_log(fretc: Fretc, tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    with path.open("rb") as stream, standard_input(stream.fileno()):
        run = fretc("info", "-")
    assert (run.status, run.err) == (0, "")
    assert run.out.splitlines()[0:3:2] == shown(path.read_bytes())


@pytest.mark.parametrize(
    ("content", "status"), [("half", 3), ("whole", 0), ("foreign", 2), ("empty", 2)]
)
def test_nothing_of_standard_input_stays_behind(
    fretc: Fretc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: str, status: int
) -> None:
    data = write(tmp_path / "log.mcap", TWELVE).read_bytes()
    place = tmp_path / "temporary"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    contents = {"half": data[: len(data) // 2], "whole": data, "foreign": b"no log", "empty": b""}
    with piped(contents[content]) as stdin, standard_input(stdin):
        assert fretc("info", "-").status == status
    assert list(place.iterdir()) == []


@pytest.mark.parametrize(("data", "code"), [(b"", "F407"), (b"hello, text\n" * 100, "F402")])
def test_empty_and_foreign_standard_input_have_their_codes(
    fretc: Fretc, data: bytes, code: str
) -> None:
    with piped(data) as stdin, standard_input(stdin):
        run = fretc("info", "-")
    assert (run.status, run.err[:4]) == (2, code)


@pytest.mark.slow
def test_closed_standard_input_has_its_code() -> None:
    found = subprocess.run(
        ["/bin/sh", "-c", f"exec {sys.executable} -c "
         "'from fretc.cli import main; main()' info - <&-"],
        capture_output=True, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=False,
    )  # fmt: skip
    assert found.returncode == 2
    assert found.stderr.startswith(b"F903 standard input cannot be read: it is closed")


# URLs


@pytest.fixture
def memory(tmp_path: Path) -> Iterator[str]:
    data = write(tmp_path / "log.mcap", TWELVE, per_chunk=3).read_bytes()
    system = fsspec.filesystem("memory")
    system.pipe("/runs/log.mcap", data)
    yield "memory://runs/log.mcap"
    system.rm("/runs", recursive=True)


def recording(url: str) -> Recording:
    found = read(url, X, ["x"])
    assert isinstance(found, Recording), found
    return found


def refused(url: str) -> Diagnostic:
    found = read(url, X, ["x"])
    assert isinstance(found, Diagnostic), found
    return found


def test_a_log_at_a_url_is_the_log(memory: str, tmp_path: Path) -> None:
    found = recording(memory)
    data = (tmp_path / "log.mcap").read_bytes()
    assert values(found, "x") == [i / 100 for i in range(12)]
    assert found.sha256 == hashlib.sha256(data).hexdigest()
    assert (found.size, found.name, found.intact) == (len(data), memory, True)
    assert found.topics == recording(f"file://{tmp_path}/log.mcap").topics


def test_a_damaged_log_at_a_url_has_its_own_hash(memory: str, tmp_path: Path) -> None:
    path = write(tmp_path / "bad.mcap", TWELVE, per_chunk=3, compression=NONE)
    damaged(path, 700)
    found = recording(f"file://{path}")
    assert not found.intact
    assert found.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("url", "code"),
    [
        ("memory://runs/no.mcap", Code.NO_SUCH_FILE),
        ("memory://runs", Code.IS_A_DIRECTORY),
        ("file:///no/such/file.mcap", Code.NO_SUCH_FILE),
        ("nothing://x/y.mcap", Code.UNREADABLE),
        ("http://127.0.0.1:1/log.mcap", Code.UNREADABLE),
        ("http://[::1", Code.UNREADABLE),
    ],
)
def test_what_is_not_there_has_its_code(memory: str, url: str, code: Code) -> None:
    assert refused(url).code is code


def test_without_the_package_of_a_protocol_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gcsfs", None)
    diagnostic = refused("gs://bucket/log.mcap")
    assert diagnostic.code is Code.MISSING_EXTRA
    assert diagnostic.help == "install its package: pip install gcsfs"
    monkeypatch.setitem(sys.modules, "fsspec", None)
    diagnostic = refused("gs://bucket/log.mcap")
    assert diagnostic.code is Code.MISSING_EXTRA
    assert diagnostic.help == install_help("remote")


class Server(BaseHTTPRequestHandler):
    """Sends one log; by ranges, or only as a whole."""

    data: ClassVar[bytes] = b""
    ranges: ClassVar[bool] = True
    status: ClassVar[int] = 200
    short: ClassVar[bool] = False
    sent: ClassVar[int] = 0

    def do_HEAD(self) -> None:
        self._head(0, len(self.data), 200)

    def do_GET(self) -> None:
        asked = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        start, end, status = 0, len(self.data), 200
        if asked and self.ranges:
            start, end, status = int(asked[1]), min(int(asked[2]) + 1, end), 206
        if self._head(start, end, status):
            data = self.data[start:end]
            type(self).sent += len(data)
            self.wfile.write(data[: len(data) // 2] if self.short else data)

    def _head(self, start: int, end: int, status: int) -> bool:
        if self.status != 200:
            self.send_error(self.status)
            return False
        self.send_response(status)
        self.send_header("Content-Length", str(end - start))
        if self.ranges:
            self.send_header("Accept-Ranges", "bytes")
        if status == 206:
            self.send_header("Content-Range", f"bytes {start}-{end - 1}/{len(self.data)}")
        self.end_headers()
        return True

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def server(tmp_path: Path) -> Iterator[tuple[type[Server], str]]:
    class One(Server):
        data = write(tmp_path / "log.mcap", TWELVE, per_chunk=3).read_bytes()

    running = ThreadingHTTPServer(("127.0.0.1", 0), One)
    thread = threading.Thread(target=running.serve_forever)
    thread.start()
    yield One, f"http://127.0.0.1:{running.server_port}/log.mcap"
    running.shutdown()
    thread.join()
    running.server_close()
    fsspec.filesystem("http").invalidate_cache()


@pytest.mark.parametrize("ranges", [True, False])
def test_a_log_on_a_server_is_the_log(server: tuple[type[Server], str], ranges: bool) -> None:
    handler, url = server
    handler.ranges = ranges
    found = recording(url)
    assert values(found, "x") == [i / 100 for i in range(12)]
    assert found.sha256 == hashlib.sha256(handler.data).hexdigest()
    assert handler.sent <= 2 * len(handler.data)


@pytest.mark.slow
def test_by_its_index_little_is_asked_of_a_server(
    server: tuple[type[Server], str], tmp_path: Path
) -> None:
    handler, url = server
    noise = random.Random(1).randbytes(2**20)
    images = [Sent("/camera", "std_msgs/msg/String", noise, i * S) for i in range(1, 40)]
    sent = sorted([*(number(float(i), i * S) for i in range(1, 40, 20)), *images], key=sent_at)
    handler.data = write(tmp_path / "large.mcap", sent, per_chunk=1).read_bytes()
    found = read(url, X, ["x"], Integrity.INDEX)
    assert isinstance(found, Recording), found
    assert (values(found, "x"), found.checked.skipped) == ([1.0, 21.0], 39)
    assert handler.sent < 0.1 * len(handler.data)


def sent_at(message: Sent) -> int:
    return message.time


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (404, Code.NO_SUCH_FILE),
        (403, Code.UNREADABLE),
        (401, Code.UNREADABLE),
        (500, Code.UNREADABLE),
    ],
)
def test_what_a_server_refuses_has_its_code(
    server: tuple[type[Server], str], status: int, code: Code
) -> None:
    server[0].status = status
    diagnostic = refused(server[1])
    assert diagnostic.code is code
    assert code is Code.NO_SUCH_FILE or str(status) in diagnostic.message


@pytest.mark.parametrize("ranges", [True, False])
def test_a_server_that_hangs_up_has_its_code(
    server: tuple[type[Server], str], ranges: bool
) -> None:
    handler, url = server
    handler.ranges, handler.short = ranges, True
    assert refused(url).code is Code.UNREADABLE


def test_what_is_read_out_of_order_is_hashed_as_it_stands(memory: str, tmp_path: Path) -> None:
    data = (tmp_path / "log.mcap").read_bytes()
    with opened(memory) as log:
        assert not isinstance(log, Diagnostic)
        log.stream.seek(-10, io.SEEK_END)
        assert log.stream.read() == data[-10:]
        log.stream.seek(100)
        assert log.stream.read(5) == data[100:105]
        assert log.sha256() == hashlib.sha256(data).hexdigest()


def test_a_url_names_a_protocol() -> None:
    assert is_url("s3://bucket/run.mcap")
    assert is_url("simplecache::https://host/run.mcap")
    assert not is_url("runs/a.mcap")
    assert not is_url("C:/runs/a.mcap")


def test_what_is_secret_in_a_url_is_never_shown() -> None:
    assert name_of("https://me:word@host:8080/a.mcap?X-Amz-Signature=abc&part=1#x") == (
        "https://host:8080/a.mcap?X-Amz-Signature=...&part=1"
    )
    assert name_of("https://host/a.mcap?part=1&name=%20") == "https://host/a.mcap?part=1&name=%20"
    assert name_of("-") == "<stdin>"
    assert name_of("runs/a.mcap") == "runs/a.mcap"


def test_a_full_disk_has_its_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> Any:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    with piped(b"any") as stdin:
        saved = os.dup(0)
        os.dup2(stdin, 0)
        try:
            monkeypatch.setattr(sys, "stdin", io.StringIO())
            diagnostic = refused("-")
        finally:
            os.dup2(saved, 0)
            os.close(saved)
    assert diagnostic.code is Code.UNREADABLE
    assert "No space left on device" in diagnostic.message
    assert "TMPDIR" in str(diagnostic.help)


def written_to(monkeypatch: pytest.MonkeyPatch, change: Callable[[], object]) -> None:
    """Let somebody change a log when its messages have been read, and its hash has not."""

    def read(*arguments: Any) -> Any:
        found = contents.contents(*arguments)
        change()
        return found

    monkeypatch.setattr(containers, "contents", read)
    monkeypatch.setattr(inputs._Digest, "begin", lambda self: None)
    monkeypatch.setattr(inputs._Digest, "result", _later)


_begin, _result = inputs._Digest.begin, inputs._Digest.result


def _later(digest: inputs._Digest) -> str:
    _begin(digest)
    return _result(digest)


SIZES = pytest.mark.parametrize("small", [0, inputs._SMALL], ids=["large", "small"])


@SIZES
@pytest.mark.parametrize("integrity", list(Integrity))
@pytest.mark.parametrize("change", [b"", b"longer", b"other"])
def test_a_log_that_is_written_to_while_it_is_read_shows_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    integrity: Integrity,
    change: bytes,
    small: int,
) -> None:
    monkeypatch.setattr(inputs, "_SMALL", small)
    path = write(tmp_path / "log.mcap", TWELVE)
    os.utime(path, ns=(0, 0))
    data = path.read_bytes()
    new = {b"": data[:-20], b"longer": b"not " + data, b"other": data[:-1] + b"?"}[change]
    written_to(monkeypatch, lambda: path.write_bytes(new))
    found = read(str(path), X, ["x"], integrity)
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE


@SIZES
@pytest.mark.parametrize("integrity", list(Integrity))
@pytest.mark.parametrize("whole", [True, False])
def test_a_log_that_grows_while_it_is_read_is_what_it_was(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    integrity: Integrity,
    whole: bool,
    small: int,
) -> None:
    monkeypatch.setattr(inputs, "_SMALL", small)
    path = write(tmp_path / "log.mcap", TWELVE)
    data = path.read_bytes()
    begun = data if whole else data[: len(data) // 2]
    path.write_bytes(begun)
    still = read(str(path), X, ["x"], integrity)

    def grow() -> None:
        with path.open("ab") as file:
            file.write(data[len(begun) :] or b"more")

    written_to(monkeypatch, grow)
    grown = read(str(path), X, ["x"], integrity)
    assert isinstance(still, Recording)
    assert isinstance(grown, Recording)
    assert values(grown, "x") == values(still, "x")
    assert (grown.sha256, grown.size) == (still.sha256, len(begun))
    assert grown.intact is whole
    *found, finding = grown.findings
    assert found == list(still.findings)
    assert render(finding) == (
        f"F431 warning: the log grew while it was read: the audit covers the first {len(begun):,} "
        f"bytes\n  --> {path}\nhelp: audit it again when its recording, or its copy, is complete"
    )


@SIZES
def test_a_log_that_is_no_longer_what_it_was_has_not_grown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, small: int
) -> None:
    monkeypatch.setattr(inputs, "_SMALL", small)
    path = write(tmp_path / "log.mcap", TWELVE)
    data = path.read_bytes()
    hashed = hashlib.sha256(data).hexdigest()
    written_to(monkeypatch, lambda: path.write_bytes(data[:-1] + b"??"))
    monkeypatch.setattr(inputs._Digest, "result", lambda self: hashed)  # it came first
    found = read(str(path), X, ["x"])
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE


@pytest.mark.parametrize("integrity", list(Integrity))
def test_a_log_that_is_swapped_while_it_is_read_shows_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, integrity: Integrity
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    other = write(tmp_path / "other.mcap", TWELVE[:4])
    written_to(monkeypatch, lambda: other.replace(path))
    found = read(str(path), X, ["x"], integrity)
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE


def test_nor_does_one_whose_time_is_set_back_after_it_was_written_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    os.utime(path, ns=(0, 0))
    data = path.read_bytes()

    def change() -> None:
        with path.open("r+b") as file:  # as long as before
            file.write(data[:-1] + b"?")
        os.utime(path, ns=(0, 0))

    time.sleep(0.05)  # a tick of the file system's clock
    written_to(monkeypatch, change)
    found = read(str(path), X, ["x"])
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE


def test_nor_does_one_that_is_another_file_for_a_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, other = write(tmp_path / "log.mcap", TWELVE), write(tmp_path / "other.mcap", TWELVE[:4])

    def swap() -> None:
        path.rename(tmp_path / "away")
        other.rename(path)
        path.rename(other)
        (tmp_path / "away").rename(path)

    time.sleep(0.05)
    written_to(monkeypatch, swap)
    found = read(str(path), X, ["x"])
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE
