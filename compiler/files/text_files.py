"""Reading text files with diagnostics, and writing outputs completely or not at all."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import field
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO, Literal

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, suggestion
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.memory import same
from fretish.system.files import NO_WAIT, TO_CREATE, TO_READ, replace, set_permissions

MOST = 2**30
"""Maximum size in bytes of a file that is read at once."""


def read(path: str, errors: Literal["strict", "surrogateescape"] = "strict") -> Source | Diagnostic:
    """The text of a file (`-`: standard input), or the diagnostic why it cannot be read.

    Args:
        path: the path of the file.
        errors: as for `bytes.decode`; a file that lists file names may contain names that are not
            UTF-8.
    """
    try:
        if not path:
            raise FileNotFoundError
        if path == "-":
            with open(0, "rb", closefd=False) as stdin:
                return Source("<stdin>", stdin.read().decode("utf-8-sig", errors))
        text = _unsaved_text(path)
        if text is None:
            text = content(path).decode("utf-8-sig", errors)
        return same(Source(path, text), Source, path, text)
    except UnicodeDecodeError as error:
        return diagnostic("not_text", Source(path, "").span(), path=path, at=error.start)
    except OSError as error:
        return unreadable(path, error)


_unsaved: ContextVar[Mapping[str, str]] = ContextVar("_unsaved", default=MappingProxyType({}))
"""Absolute path → the text that an editor shows for the file."""


@contextmanager
def unsaved_texts(texts: Mapping[str, str]) -> Iterator[None]:
    """Context in which some files have the text of an editor, whatever the disk has.

    Args:
        texts: absolute path → text; without a byte order mark.
    """
    token = _unsaved.set(texts)
    try:
        yield
    finally:
        _unsaved.reset(token)


def is_file(path: str | Path) -> bool:
    """Whether there is a regular file, or an editor has a text for the path."""
    return _unsaved_text(str(path)) is not None or Path(path).is_file()


def unsaved_names(folder: str) -> list[str]:
    """The names of the files of a folder for which an editor has a text."""
    texts = _unsaved.get()
    here = os.path.abspath(folder) if texts else ""
    return [os.path.basename(path) for path in texts if os.path.dirname(path) == here]


def _unsaved_text(path: str) -> str | None:
    texts = _unsaved.get()
    return texts.get(os.path.abspath(path)) if texts else None


def content(path: str | Path) -> bytes:
    """The bytes of a regular file.

    Raises:
        OSError: the file cannot be read, is a pipe or a device, or is larger than `MOST`.
    """
    with open_regular(path) as file:
        data = file.read(MOST + 1)
    if len(data) > MOST:
        raise OSError(None, f"it is larger than {MOST // 2**20} MiB")
    return data


def open_regular(path: str | Path) -> BinaryIO:
    """An open regular file: never a pipe, which may block, or a device, which may be endless.

    A path in /dev counts as the user's choice if the user names it so, as `<(...)` of a shell does;
    a link to it in somebody else's folder does not.

    Raises:
        OSError: the file cannot be opened, or is not a regular file.
    """
    own = str(path).startswith("/dev/")
    descriptor = os.open(path, TO_READ if own else TO_READ | NO_WAIT)
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode) or (own and not stat.S_ISDIR(mode)):
        return os.fdopen(descriptor, "rb")
    os.close(descriptor)
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    raise OSError(None, "it is not a regular file")


def unreadable(path: str, error: OSError) -> Diagnostic:
    """F901, F902 or F903, depending on the error of the operating system."""
    span = Source(path, "").span()
    if isinstance(error, FileNotFoundError):
        return diagnostic("no_file", span, path=path, help=_nearest(path))
    if isinstance(error, IsADirectoryError):
        return diagnostic("path_is_directory", span, path=path)
    return diagnostic("file_unreadable", span, path=path, reason=error.strerror or error)


def _nearest(path: str) -> str:
    if os.path.islink(path):
        return f"it is a link to `{os.readlink(path)}`, which is not there: copy what it stands for"
    folder = Path(path).parent
    try:
        near = suggestion(Path(path).name, (entry.name for entry in folder.iterdir()))
    except OSError:
        return f"there is no folder `{folder}` either"
    return f"did you mean `{folder / near}`?" if near else "check the name and the folder"


def write(files: Mapping[Path, str | bytes | Iterable[str]]) -> Diagnostic | None:
    """Write all files: each under a temporary name first, then renamed.

    No partly written file is left: if one file cannot be written, none is replaced. A file keeps
    its permissions, and only a regular file is replaced. A link is followed if it stays in its
    folder. Until the rename, no other user can read the content. A text that begins with `#!`
    becomes executable for those who may read it.
    """
    waiting: list[tuple[Path, Path]] = []
    path = Path()
    try:
        for path, content in files.items():
            real = destination(path)
            real.parent.mkdir(parents=True, exist_ok=True)
            if real.exists() and not real.is_file():
                kind = "a directory of that name" if real.is_dir() else "something else there"
                raise OSError(None, f"there is {kind}")
            # Known before it is made: an interruption at any moment finds it here.
            temporary = real.parent / f".{real.name[:100]}.{os.urandom(4).hex()}.tmp"
            waiting.append((temporary, real))
            _fill(temporary, content, like=real)
        for temporary, path in waiting:
            replace(temporary, path)
    except OSError as error:
        return diagnostic("file_not_written", path=path, reason=error.strerror or error)
    finally:
        for temporary, _ in waiting:
            with suppress(OSError):  # the disk is read-only: it was never made
                temporary.unlink()
    return None


def _fill(temporary: Path, content: str | bytes | Iterable[str], *, like: Path) -> None:
    """Write a new file, with the permissions of the one that it will replace, if there is one."""
    whole = (content,) if isinstance(content, str | bytes) else content
    pieces = (piece.encode() if isinstance(piece, str) else piece for piece in whole)
    data = next(pieces, b"")
    mode = stat.S_IMODE(like.stat().st_mode) if like.exists() else _default_permissions()
    if data.startswith(b"#!"):
        mode |= (mode & _READABLE) >> 2
    descriptor = os.open(temporary, TO_CREATE, 0o600)
    with os.fdopen(descriptor, "wb") as file:
        file.write(data)
        file.writelines(pieces)
        file.flush()
        set_permissions(temporary, descriptor, mode)


def _default_permissions() -> int:
    """The permissions of a new file under the present umask."""
    mask = os.umask(0o077)
    os.umask(mask)
    return 0o666 & ~mask


def destination(path: Path) -> Path:
    """The path of an output after following links.

    The content of the current folder, links included, may come from somebody else. A relative path
    must stay below that folder (or the one above that it names by `..`); an absolute path is the
    user's choice.

    Raises:
        OSError: a link leads outside.
    """
    folder, real = Path(os.path.realpath(path.parent)), Path(os.path.realpath(path))
    if not path.is_absolute():
        base = Path.cwd()
        for part in path.parts:
            if part != "..":
                break
            base = base.parent
        if not folder.is_relative_to(os.path.realpath(base)):
            raise OSError(
                None, f"`{path.parent}` is a link to `{folder}`: name `{folder}` if you mean it"
            )
    if not real.is_relative_to(folder):
        raise OSError(None, f"it is a link to `{real}`: name `{real}` if you mean it")
    return real


_READABLE = stat.S_IRUSR | stat.S_IRGRP | stat.S_IROTH
"""Read permissions; each lies two bits above the permission to execute."""


def sha256(text: str) -> str:
    """SHA-256 of the text in UTF-8, in hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def file_sha256(path: str) -> str | None:
    """SHA-256 of a regular file, in hexadecimal; None if it is not regular or cannot be read."""
    if not Path(path).is_file():
        return None
    try:
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


@dataclass(frozen=True, slots=True)
class Stamp:
    """Identity of a regular file (size, times, inode): while it is equal, so are the bytes.

    Anybody can set `mtime_ns` back; `ctime_ns` changes only with the clock of the machine.
    """

    size: int
    mtime_ns: int
    ctime_ns: int
    inode: int
    settled: bool = field(compare=False)
    """False if the file had just been changed: another change within the same tick of the file
    system's clock would not show in the stamp."""


def stamp(path: str) -> Stamp | None:
    """The stamp of a file; None if the path is missing or not a regular file."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    if not stat.S_ISREG(status.st_mode):
        return None
    age = time.time_ns() - max(status.st_mtime_ns, status.st_ctime_ns)
    return Stamp(
        status.st_size,
        status.st_mtime_ns,
        status.st_ctime_ns,
        status.st_ino,
        settled=age > _COARSEST,
    )


_COARSEST = 2 * 10**9
"""Nanoseconds: the coarsest clock of a file system is FAT's, with ticks of two seconds."""
