"""Files: descriptors, locks of folders, and replacement of a file that another program reads."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

_BYTES = getattr(os, "O_BINARY", 0)
"""Windows translates line ends of descriptors without it."""
_CLOSED_IN_CHILDREN = getattr(os, "O_CLOEXEC", 0)
NO_LINK: int = getattr(os, "O_NOFOLLOW", 0)
"""Flag of `os.open` by which a link is an error. Windows has none, but only administrators may
create links there."""
NO_WAIT: int = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
"""Flags by which a pipe or a terminal is opened without waiting. Windows has no files of these
kinds."""
FOLDER: int = getattr(os, "O_DIRECTORY", 0)
"""Flag by which only a folder is opened."""
TO_READ: int = os.O_RDONLY | _BYTES | _CLOSED_IN_CHILDREN
"""Flags of a file of bytes that is read."""
TO_CREATE: int = os.O_CREAT | os.O_EXCL | os.O_WRONLY | NO_LINK | _BYTES | _CLOSED_IN_CHILDREN
"""Flags of a new file of bytes; it is an error if there is one."""
OPENS_FOLDERS = os.open in os.supports_dir_fd
"""Whether a folder can be opened, and a file opened in it. Windows cannot."""
_ATTEMPTS = 20
"""Attempts to replace a file that another program reads."""
_PAUSE = 0.05
"""Seconds between two attempts."""


def replace(source: Path, target: Path) -> None:
    """Rename a file, also over an existing one, as `os.replace`.

    Windows refuses this while another program, such as a virus scanner, reads one of the files. It
    is tried again for a second.

    Raises:
        OSError: the file cannot be replaced.
    """
    for _ in range(_ATTEMPTS if sys.platform == "win32" else 0):
        try:
            source.replace(target)
        except PermissionError:
            time.sleep(_PAUSE)
        else:
            return
    source.replace(target)


def set_permissions(path: Path, descriptor: int, mode: int) -> None:
    """Set the permissions of an open file; Windows knows only whether it may be written to."""
    if hasattr(os, "fchmod"):
        os.fchmod(descriptor, mode)
    else:
        path.chmod(mode)


def is_private(status: os.stat_result) -> bool:
    """Whether no other user may read or write a file.

    On Windows the permissions of the folder decide that; a user's own folder is private there.
    """
    return sys.platform == "win32" or not status.st_mode & 0o077


def is_own(status: os.stat_result) -> bool:
    """Whether a file belongs to the user of this process. Windows does not tell: then it does."""
    return not hasattr(os, "geteuid") or bool(status.st_uid == os.geteuid())


def read_at(descriptor: int, length: int, at: int) -> bytes:
    """At most so many bytes of an open file from a position on.

    Without `os.pread` (Windows) this moves the position of the descriptor, which no other thread
    may read then.
    """
    if hasattr(os, "pread"):
        data: bytes = os.pread(descriptor, length, at)
        return data
    os.lseek(descriptor, at, os.SEEK_SET)
    return os.read(descriptor, length)


def for_second_thread(descriptor: int, path: str) -> int:
    """Another descriptor of an open file, with which a second thread can call `read_at`.

    Without `os.pread` it has a position of its own, for which the file is opened again by its path.

    Raises:
        OSError: the path now belongs to another file.
    """
    if hasattr(os, "pread"):
        return os.dup(descriptor)
    own = os.open(path, TO_READ)
    if os.path.samestat(os.fstat(own), os.fstat(descriptor)):
        return own
    os.close(own)
    raise OSError(None, "its name now belongs to another file")


class FolderLock:
    """A lock of a folder: at most one process has it, and the system releases it at its end."""

    def __init__(self, folder: Path) -> None:
        """Lock an existing folder.

        POSIX locks the folder itself. Windows cannot: there it is a file beside the folder, which
        the system removes when the lock is released. A system without either has no lock.

        Raises:
            BlockingIOError: another process has the lock.
            OSError: the folder cannot be opened.
        """
        if sys.platform == "win32":
            name = folder.absolute().with_name(f".{folder.absolute().name}.lock")
            self._file = os.open(name, os.O_CREAT | os.O_RDWR | os.O_TEMPORARY)
        else:
            self._file = os.open(folder, TO_READ | FOLDER)
        try:
            lock(self._file)
        except BaseException:
            self.release()
            raise

    def release(self) -> None:
        """Release the lock."""
        os.close(self._file)


def lock(descriptor: int) -> None:
    """Lock an open file until it is closed.

    Raises:
        BlockingIOError: another process has locked it.
    """
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError as error:
            raise BlockingIOError(error.errno, error.strerror) from error
        return
    try:
        import fcntl
    except ImportError:
        return
    fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
