"""The bytes of a log from a file, standard input, or a URL.

Standard input is copied to a temporary file without a name, which is deleted with the process in
any case. So is a log at a URL: a server could send other bytes for a second request, and the
audited bytes must be the hashed ones. Only a log that is read by its index, and not hashed, is read
from the server in blocks.
"""

from __future__ import annotations

import errno
import hashlib
import io
import os
import shutil
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, cast

from fretc.logs.storage import storage_diagnostics, web
from fretc.logs.storage.log_names import STDIN, is_url, name_of
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.limits import extend_budget
from fretish.system.files import for_second_thread, read_at

_MOST = 2**36
"""The most bytes of a log whose length the server does not state."""
_SMALL_BLOCK = 2**14
"""Bytes of one request if most of the file is skipped."""
_SLOW = "the server sends hardly any data"
_HASHED = 2**18
"""Bytes of one step of hashing."""
_SMALL = 2**20
"""Bytes up to which a file is read at once, and hashed without a thread."""


@dataclass(frozen=True, slots=True)
class OpenLog:
    """A log that is open for reading."""

    stream: io.BufferedReader
    size: int
    sha256: Callable[[], str]
    """Compute the SHA-256 of all bytes; to be called after reading."""
    begin: Callable[[], None]
    """Start to hash in parallel with reading, if possible."""
    file: str | None
    """The path; None: the input is not a file."""
    same: str | None
    """Another path of the open file itself, even if its name now belongs to another file."""
    changed: Callable[[], bool] = lambda: False
    """Whether the file was written to since it was opened, or its name now belongs to another
    file."""
    beginning: Callable[[], OpenLog | None] = lambda: None
    """A copy of the bytes that were there when the file was opened; None: it has changed otherwise
    than by growing."""
    episode: int | None = None
    """The run of a table that holds several; None: the whole file is one."""


@contextmanager
def opened(path: str, *, whole: bool = True) -> Iterator[OpenLog | Diagnostic]:
    """The log at a path, open within the context; or why it cannot be opened.

    Args:
        path: a file, a URL, or `-`.
        whole: whether all of it will be read; if not, requests to a server are smaller.

    Reading from it can raise OSError.
    """
    with ExitStack() as stack:
        try:
            log = _opened(path, stack, whole=whole)
        except FileNotFoundError:
            log = diagnostic("no_such_log", Source(name_of(path), "").span())
        except OSError as error:
            log = storage_diagnostics.unreadable(error, Source(name_of(path), "").span())
        yield log


def _opened(path: str, stack: ExitStack, *, whole: bool) -> OpenLog | Diagnostic:
    if path == STDIN:
        return _stdin(stack)
    if is_url(path):
        return _remote(path, stack, whole=whole)
    mode = os.stat(path).st_mode
    if stat.S_ISDIR(mode):
        return diagnostic("log_is_directory", Source(name_of(path), "").span())
    if not stat.S_ISREG(mode):
        return diagnostic("not_a_regular_file", Source(name_of(path), "").span())
    stream = stack.enter_context(Path(path).open("rb"))  # noqa: SIM115
    before = os.fstat(stream.fileno())
    content = stream.read(before.st_size) if before.st_size <= _SMALL else None

    def changed() -> bool:
        try:
            statuses = (os.fstat(stream.fileno()), os.stat(path))
        except OSError:
            return True
        return any(_mark(now) != _mark(before) for now in statuses)

    def beginning() -> OpenLog | None:
        now = os.stat(path)
        if _mark(now)[:2] != _mark(before)[:2] or now.st_size <= size:
            return None
        stream.seek(0)
        copy = _copy(_copied(stream, stack, size))
        return copy if (copy.size, copy.sha256()) == (size, sha256()) else None

    file, size = stream.fileno(), before.st_size
    same = f"/proc/self/fd/{file}"
    same = same if os.path.exists(same) else path  # as on macOS; `changed` then tells
    sha256: Callable[[], str]
    if content is not None:
        held = cast("io.BufferedReader", io.BytesIO(content))
        size, sha256 = len(content), partial(_sha256, content)
        return OpenLog(held, size, sha256, _nothing, path, same, changed, beginning)
    digest = _Digest(file, size, path)
    sha256 = digest.result
    return OpenLog(stream, size, sha256, digest.begin, path, same, changed, beginning)


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _nothing() -> None:
    """What need not be done."""


def _mark(status: os.stat_result) -> tuple[int, ...]:
    """The attributes that change with a write, or with another file of the same name.

    Anyone who may write to a file can set `st_mtime` back, but `st_ctime` only by the machine's
    clock.
    """
    times = status.st_mtime_ns, status.st_ctime_ns
    return (status.st_dev, status.st_ino, status.st_size, *times)


class _Digest:
    """The SHA-256 of a file from a second thread: hashing releases the interpreter lock.

    It hashes the open file itself: its name may now belong to another one.
    """

    def __init__(self, descriptor: int, size: int, path: str) -> None:
        self._descriptor, self._size, self._path = descriptor, size, path
        self._thread: threading.Thread | None = None
        self._result: str | OSError = ""

    def begin(self) -> None:
        if self._thread is None:
            # the reader may be closed before the hash is complete
            own = for_second_thread(self._descriptor, self._path)
            self._thread = threading.Thread(target=self._run, args=(own,), daemon=True)
            self._thread.start()

    def result(self) -> str:
        self.begin()
        assert self._thread is not None
        self._thread.join()
        if isinstance(self._result, OSError):
            raise self._result
        return self._result

    def _run(self, own: int) -> None:
        digest, at = hashlib.sha256(), 0
        try:
            while at < self._size:
                block = read_at(own, min(_HASHED, self._size - at), at)
                if not block:
                    raise OSError(None, "it became shorter while it was read")
                digest.update(block)
                at += len(block)
            self._result = digest.hexdigest()
        except OSError as error:
            self._result = error
        finally:
            os.close(own)


def _copy(stream: io.BufferedReader) -> OpenLog:
    """A copy of a file without a path."""
    digest = hashlib.file_digest(stream, "sha256").hexdigest()
    size = stream.tell()
    stream.seek(0)
    return OpenLog(stream, size, lambda: digest, lambda: None, None, None)


# Standard input


def _stdin(stack: ExitStack) -> OpenLog | Diagnostic:
    if sys.stdin is None or sys.stdin.closed:
        return storage_diagnostics.no_stdin("it is closed")
    if sys.stdin.isatty():
        return storage_diagnostics.no_stdin("it is a terminal")
    stdin = stack.enter_context(_reader(0))
    if stat.S_ISREG(os.fstat(0).st_mode) and stdin.tell() == 0:
        return _copy(stdin)
    return _copy(_copied(stdin, stack))


def _copied(source: BinaryIO, stack: ExitStack, most: int | None = None) -> io.BufferedReader:
    """The rest of a stream, or at most so many bytes of it, in a file without a name."""
    copy = stack.enter_context(tempfile.TemporaryFile())  # noqa: SIM115
    left = sys.maxsize if most is None else most
    while block := source.read(min(web.BLOCK, left)):
        copy.write(block)
        left -= len(block)
        extend_budget(len(block))
    copy.flush()
    copy.seek(0)
    return stack.enter_context(_reader(copy.fileno()))


def _reader(descriptor: int) -> io.BufferedReader:
    return cast("io.BufferedReader", io.BufferedReader(io.FileIO(descriptor, closefd=False)))


# URLs


class _HashingFile(io.RawIOBase):
    """A file at a URL. Bytes that are read in order are hashed at the same time."""

    def __init__(self, file: Any, size: int) -> None:
        self._file, self._size = _PacedStream(file, _SMALL_BLOCK), size
        self._at = self._hashed = 0
        self._digest = hashlib.sha256()

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size}[whence]
        self._at = max(0, start + offset)
        return self._at

    def readinto(self, buffer: Any) -> int:
        data = self._read(len(buffer))
        buffer[: len(data)] = data
        return len(data)

    def _read(self, length: int) -> bytes:
        length = max(0, min(length, self._size - self._at))
        data = self._file.read(length, self._at)
        if length and not data:
            raise OSError(None, f"the server sent nothing from byte {self._at} on")
        if self._at <= self._hashed < self._at + len(data):
            self._digest.update(data[self._hashed - self._at :])
            self._hashed = self._at + len(data)
        self._at += len(data)
        return data

    def sha256(self) -> str:
        self._at = self._hashed
        while self._hashed < self._size:
            self._read(web.BLOCK)
        return self._digest.hexdigest()


def _remote(url: str, stack: ExitStack, *, whole: bool) -> OpenLog | Diagnostic:
    span = Source(name_of(url), "").span()
    try:
        import fsspec

        system, path = fsspec.core.url_to_fs(url, **web.options(url))
        about = system.info(path)
        if about.get("type") == "directory":
            return diagnostic("log_is_directory", span)
        size = about.get("size")
        if size is None or about.get("partial") is False:
            file = stack.enter_context(closing(_stream(system, path)))
            return _copy(_copied(_LimitedStream(file, size), stack))
        if whole:
            file = stack.enter_context(system.open(path, "rb", block_size=web.BLOCK))
            return _copy(_copied(_LimitedStream(file, size), stack))
        file = stack.enter_context(system.open(path, "rb", block_size=_SMALL_BLOCK))
    except ImportError as error:
        return storage_diagnostics.no_package(url, error, span)
    except Exception as error:  # each protocol raises its own exceptions
        raise as_os_error(error) from error
    hashed = _HashingFile(file, size)
    stream = stack.enter_context(io.BufferedReader(hashed, _SMALL_BLOCK))
    return OpenLog(cast("io.BufferedReader", stream), size, hashed.sha256, lambda: None, None, None)


def _stream(system: Any, path: str) -> Any:
    """All bytes from the beginning on, if the server does not support ranges."""
    return (
        web.WebStream(system, path) if web.is_web(path) else system.open(path, "rb", block_size=0)
    )


class _PacedStream:
    """The bytes from a server; its errors become OSError, and slowness is an error."""

    def __init__(self, file: Any, least: int = 0) -> None:
        """`least`: the least number of bytes that each request counts for."""
        self._file, self._least = file, least
        self._due, self._spent = 0, 0.0

    def read(self, length: int | None, start: int | None = None) -> bytes:
        since = time.monotonic()
        try:
            if start is not None:
                self._file.seek(start)
            data = bytes(self._file.read(length))
        except Exception as error:  # each protocol raises its own exceptions
            raise as_os_error(error) from error
        self._spent += time.monotonic() - since
        self._due += max(self._least, len(data))
        if self._spent > web.PATIENCE + self._due / web.SLOWEST:
            raise OSError(None, _SLOW)
        return data


class _LimitedStream(io.BytesIO):
    """The bytes from a server, up to a limit and to the free space.

    If the size is known, all of them come, or an error.
    """

    def __init__(self, file: Any, size: int | None) -> None:
        super().__init__()
        self._file, self._size, self._got = _PacedStream(file), size, 0
        room = shutil.disk_usage(tempfile.gettempdir()).free
        if size is not None and size > room:
            raise OSError(None, f"it has {size} bytes, but there is only room for {room} of a copy")
        self._most = min(_MOST, room) if size is None else size

    def read(self, length: int | None = -1) -> bytes:
        data = self._file.read(length)
        self._got += len(data)
        if self._got > self._most:
            raise OSError(None, "the server sends more than a log has, or than there is room for")
        if not data and self._size not in (None, self._got):
            raise OSError(None, f"the server sent nothing from byte {self._got} on")
        return data


def as_os_error(error: Exception) -> OSError:
    """An error of a protocol as an OSError; each protocol has errors of its own."""
    if isinstance(error, FileNotFoundError) and isinstance(error.__cause__, Exception):
        error = error.__cause__  # fsspec hides the real error behind "no such file"
    if isinstance(error, TimeoutError):
        return OSError(None, _SLOW)
    if isinstance(error, FileNotFoundError | PermissionError):
        return error
    status = getattr(error, "status", None)
    if status == 404:
        return FileNotFoundError(errno.ENOENT, "not found")
    text = str(error).strip().partition("\n")[0] or type(error).__name__
    return OSError(None, f"the server answered {status}" if status else text[:200])
