"""Quotes of file names in commands for users to paste: no name becomes an option or a command."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable

_SHA256 = re.compile(r"[0-9a-f]{64}")


class UnencodableNameError(Exception):
    """A name with characters that are no text: what is pasted from a page would be another one."""


def word(name: str) -> str:
    """The name of a file as a shell reads it; never an option.

    Raises:
        UnencodableNameError: it has a line break, or a character that is not seen.
    """
    if not name.isprintable() or not name:
        raise UnencodableNameError(name)
    return shlex.quote(f"./{name}" if name.startswith("-") else name)


def words(names: Iterable[str]) -> str:
    """Names, one after the other."""
    return " ".join(map(word, names))


def unsayable(name: str) -> str:
    """In the place of a command: a comment, on one line."""
    return f"# no command: a name has characters that cannot be pasted: {name!a}"


def check_of(hashes: Iterable[tuple[str, str]]) -> str:
    """The command that compares files with their hashes.

    Args:
        hashes: SHA-256 and name; what is no SHA-256 is left out.

    Raises:
        UnencodableNameError: as `word` does.
    """
    lines = [shlex.quote(_line(sha256, name)) for sha256, name in hashes if is_sha256(sha256)]
    return f"printf '%s\\n' {' '.join(lines)} | sha256sum --check" if lines else ""


def _line(sha256: str, name: str) -> str:
    """As `sha256sum` writes it: where a name has a backslash, the line begins with one."""
    word(name)
    escaped = name.replace("\\", "\\\\")
    return f"{'' if escaped == name else chr(92)}{sha256}  {escaped}"


def is_sha256(text: str) -> bool:
    """Whether it is one, in hexadecimal."""
    return _SHA256.fullmatch(text) is not None
