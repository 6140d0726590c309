"""Shell quoting of file names: no name becomes an option or a command when it is pasted."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable

_SHA256 = re.compile(r"[0-9a-f]{64}")


class UnencodableNameError(Exception):
    """A name with characters that cannot be pasted faithfully from a page."""


def word(name: str) -> str:
    """The name of a file quoted for a shell; never an option.

    Raises:
        UnencodableNameError: the name has a line break, or an invisible character.
    """
    if not name.isprintable() or not name:
        raise UnencodableNameError(name)
    return shlex.quote(f"./{name}" if name.startswith("-") else name)


def words(names: Iterable[str]) -> str:
    """The quoted names, separated by spaces."""
    return " ".join(map(word, names))


def unquotable_comment(name: str) -> str:
    """A comment on one line that replaces a command which cannot be quoted."""
    return f"# no command: a name has characters that cannot be pasted: {name!a}"


def check_of(hashes: Iterable[tuple[str, str]]) -> str:
    """The command that compares files with their hashes.

    Args:
        hashes: SHA-256 and name; entries without a valid SHA-256 are left out.

    Raises:
        UnencodableNameError: as `word` does.
    """
    lines = [shlex.quote(_line(sha256, name)) for sha256, name in hashes if is_sha256(sha256)]
    return f"printf '%s\\n' {' '.join(lines)} | sha256sum --check" if lines else ""


def _line(sha256: str, name: str) -> str:
    """A line of `sha256sum`: it begins with a backslash if the name contains one."""
    word(name)
    escaped = name.replace("\\", "\\\\")
    return f"{'' if escaped == name else chr(92)}{sha256}  {escaped}"


def is_sha256(text: str) -> bool:
    """Whether the text is a SHA-256 in hexadecimal."""
    return _SHA256.fullmatch(text) is not None
