"""The suffixes of logs, the printable name of a log for every output, and the path for a name.

The name of a file may contain any byte except `/` and NUL, also bytes that are not text or that
move the cursor. Its printable name has an escape for each such byte, so that it is one line of
text, is unique, and can be converted back to the path.
"""

from __future__ import annotations

import os
import re
import shlex
from urllib.parse import parse_qsl, urlencode, urlsplit, urlunsplit

LOGS = (".mcap", ".bag", ".db3", ".ulg", ".BIN")
"""Suffixes of files that are nothing but logs."""
TEXT_TABLES = (".csv", ".tsv", ".jsonl", ".ndjson")
ARROW_TABLES = (".parquet", ".feather", ".arrow")
"""Suffixes of tables in Parquet and Arrow, which may hold several runs."""
TABLES = (*TEXT_TABLES, *ARROW_TABLES)
"""Suffixes of tables, which may be logs."""
STDIN = "-"
_STDIN_NAME = "<stdin>"
_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.:-]+://.*", re.DOTALL)
_SECRET = re.compile(r"sig|token|key|cred|secret|passw|auth", re.IGNORECASE)
_ESCAPES = {"\\": r"\\", "\n": r"\n", "\r": r"\r"}
"""As `sha256sum` writes them; each byte of another character is `\\xff`."""
_ESCAPED = re.compile(r"(\\(?:\\|n|r|x[0-9a-f]{2}))")


def is_url(path: str) -> bool:
    """Whether the path is a URL: it names a protocol."""
    return _URL.fullmatch(path) is not None


def name_of(path: str) -> str:
    """The name of a log: printable, of this path alone, and without the secrets of a URL."""
    if path == STDIN:
        return _STDIN_NAME
    if path == _STDIN_NAME:
        return f"./{path}"
    public = _without_secrets(path) if is_url(path) else path.replace(os.sep, "/")
    if public.isprintable() and "\\" not in public:
        return public
    return "".join(
        character if character.isprintable() and character != "\\" else _escape(character)
        for character in public
    )


def path_of(name: str) -> str:
    """The path or URL for the printable name of a log.

    A name that `name_of` cannot give, as in evidence from elsewhere, is taken for a path.
    """
    if "\\" not in name:
        return name
    back = {escape: character.encode() for character, escape in _ESCAPES.items()}
    data = b"".join(
        back.get(part) or bytes.fromhex(part[2:]) if i % 2 else part.encode()
        for i, part in enumerate(_ESCAPED.split(name))
    )
    path = os.fsdecode(data)
    return path if name_of(path) == name and "\0" not in path else name


def shell_word(path: str) -> str:
    """A path as a word of a shell command: quoted, printable, and never an option.

    Between `$'` and `'` shells interpret the escapes of a name in the same way.
    """
    name = f"./{path}" if path.startswith("-") and path != STDIN else path
    if name.isprintable():
        return shlex.quote(name)
    escaped = name_of(name).replace("'", r"\'")
    return f"$'{escaped}'"


def _escape(character: str) -> str:
    if character in _ESCAPES:
        return _ESCAPES[character]
    if "\udc80" <= character <= "\udcff":
        return f"\\x{ord(character) - 0xDC00:02x}"
    return "".join(f"\\x{byte:02x}" for byte in character.encode("utf-8", "surrogatepass"))


def _without_secrets(url: str) -> str:
    try:
        parts = urlsplit(url)
        pairs = parse_qsl(parts.query, keep_blank_values=True)
    except ValueError:
        return url.partition("://")[0] + "://?"
    query = parts.query
    if any(_SECRET.search(name) for name, _ in pairs):
        hidden = [(name, "..." if _SECRET.search(name) else value) for name, value in pairs]
        query = urlencode(hidden, safe="./", errors="surrogateescape")
    return urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, query, ""))
