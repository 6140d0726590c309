"""The encoding in which Python reads a source text."""

from __future__ import annotations

import tokenize
from io import BytesIO


def is_utf8(text: str) -> bool:
    """Whether Python reads a file with this text in UTF-8, as fretc does.

    With another encoding a comment could contain code. Source: PEP 263.
    """
    lines = text.replace("\r\n", "\n").replace("\r", "\n").encode()
    try:
        encoding, _ = tokenize.detect_encoding(BytesIO(lines).readline)
    except SyntaxError:
        return False
    return encoding in ("utf-8", "utf-8-sig")
