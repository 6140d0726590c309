"""Messages as JSON or CBOR, as rosbridge encodes them.

A message is a dict of numbers, texts, truth values, lists, dicts, `bytes`, and arrays of Python's
module `array`. JSON has no NaN and no infinities: rosbridge writes null. CBOR has them, and arrays
of one type.

Source: RFC 8949 (CBOR), RFC 8746 (typed arrays).
"""

from __future__ import annotations

import base64
import json
import math
import struct
import sys
from array import array
from typing import Any

_TAGS = {
    **{"b": 72, "h": 77, "i": 78, "q": 79},
    **{"B": 64, "H": 69, "I": 70, "Q": 71},
    **{"f": 85, "d": 86},
}
"""Type code of an array → tag of its little-endian form."""


def as_json(value: Any) -> str:
    """The value in JSON."""
    return json.dumps(_plain(value), separators=(",", ":"), allow_nan=False)


def _plain(value: Any) -> Any:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case bytes():
            return base64.b64encode(value).decode()
        case dict():
            return {name: _plain(each) for name, each in value.items()}
        case list() | tuple() | array():
            return [_plain(each) for each in value]
        case _:
            return value


def as_cbor(value: Any) -> bytes:
    """The value in CBOR.

    Raises:
        TypeError: CBOR cannot hold the value.
    """
    parts: list[bytes] = []
    _write(value, parts)
    return b"".join(parts)


def _write(value: Any, parts: list[bytes]) -> None:
    match value:
        case None | bool():
            parts.append({None: b"\xf6", True: b"\xf5", False: b"\xf4"}[value])
        case int():
            parts.append(_head(0, value) if value >= 0 else _head(1, -1 - value))
        case float():
            parts.append(b"\xfb" + struct.pack(">d", value))
        case str():
            encoded = value.encode()
            parts.extend((_head(3, len(encoded)), encoded))
        case bytes():
            parts.extend((_head(2, len(value)), value))
        case array():
            data = value if sys.byteorder == "little" else array(value.typecode, value)
            if data is not value:
                data.byteswap()
            parts.append(_head(6, _TAGS[value.typecode]))
            _write(data.tobytes(), parts)
        case list() | tuple():
            parts.append(_head(4, len(value)))
            for each in value:
                _write(each, parts)
        case dict():
            parts.append(_head(5, len(value)))
            for name, each in value.items():
                _write(name, parts)
                _write(each, parts)
        case _:
            raise TypeError(f"CBOR cannot hold {type(value).__name__}")


def _head(major: int, argument: int) -> bytes:
    if argument < 24:
        return bytes([major << 5 | argument])
    for code, size in enumerate((1, 2, 4, 8), 24):
        if argument < 1 << 8 * size:
            return bytes([major << 5 | code]) + argument.to_bytes(size, "big")
    raise TypeError("CBOR cannot hold a whole number of more than 64 bits")
