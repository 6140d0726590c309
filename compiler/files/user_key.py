"""The user's secret key, by which fretc recognizes files that it wrote for this user."""

from __future__ import annotations

import os
import secrets
import stat
from contextlib import suppress
from pathlib import Path

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.system.files import NO_LINK, NO_WAIT, TO_CREATE, TO_READ, is_own, is_private

_LENGTH = 32
"""Length of the key in bytes."""


def user_key() -> bytes | Diagnostic:
    """The key, which the first call creates; F920 if that fails.

    The key lies in the folder for program state, readable by the user only. Source: XDG Base
    Directory Specification 0.8.
    """
    path = _folder() / "journal.key"
    try:
        if not os.path.lexists(path):
            _make(path)
        return _read(path)
    except OSError as error:
        return diagnostic("unusable_user_key", path=path, reason=error.strerror or error)


def known_user_key() -> bytes | None:
    """The key if there is one; nothing is created."""
    try:
        return _read(_folder() / "journal.key")
    except OSError:
        return None


def _folder() -> Path:
    variable = os.environ.get("XDG_STATE_HOME", "")
    state = (
        Path(variable) if os.path.isabs(variable) else Path(os.path.expanduser("~/.local/state"))
    )
    return state / "fretc"


def _make(path: Path) -> None:
    """Write a complete key or none; an existing key is never replaced."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    temporary = path.with_name(f".{secrets.token_hex(8)}.tmp")
    file = os.open(temporary, TO_CREATE, 0o600)
    try:
        with os.fdopen(file, "wb") as stream:
            stream.write(secrets.token_bytes(_LENGTH))
        with suppress(FileExistsError):  # another process was faster: its key counts
            os.link(temporary, path)
    finally:
        temporary.unlink()


def _read(path: Path) -> bytes:
    file = os.open(path, TO_READ | NO_LINK | NO_WAIT)
    with os.fdopen(file, "rb") as stream:
        about = os.fstat(file)
        if not stat.S_ISREG(about.st_mode) or not is_own(about):
            raise OSError(None, "it belongs to another user")
        if not is_private(about):
            raise OSError(None, "other users may read or write it")
        key = stream.read(_LENGTH + 1)
    if len(key) != _LENGTH:
        raise OSError(None, "it is not a key")
    return key
