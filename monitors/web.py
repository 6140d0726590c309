"""What a web server may do while a log is read from it: send what was asked for, and no more.

The only module that imports aiohttp, through which fsspec speaks to `http` and `https`.
"""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

SCHEMES = frozenset({"http", "https"})
_CONNECT, _SILENCE = 30, 60
"""Seconds: for a connection, and between two pieces of an answer."""
_RANGE = re.compile(r"bytes=(\d+)-(\d+)")


def options(url: str) -> dict[str, Any]:
    """What fsspec is to be told for a URL; nothing where that is no web server's."""
    scheme = urlsplit(url).scheme.lower()
    if scheme not in SCHEMES:
        return {}
    return {"get_client": _only_safe if scheme == "https" else _any}


async def _only_safe(**arguments: Any) -> Any:
    return _client("https", **arguments)


async def _any(**arguments: Any) -> Any:
    return _client("http", **arguments)


def _client(scheme: str, **arguments: Any) -> Any:
    """A session; what is unpacked on the way could be of any size, so nothing is."""
    import aiohttp

    hooks = aiohttp.TraceConfig()
    hooks.on_request_redirect.append(_redirects(scheme))
    hooks.on_request_end.append(_check_answer)
    limits = aiohttp.ClientTimeout(total=None, sock_connect=_CONNECT, sock_read=_SILENCE)
    return aiohttp.ClientSession(
        trace_configs=[hooks], timeout=limits, auto_decompress=False, **arguments
    )


def _redirects(scheme: str) -> Any:
    """From `https` a server may send us to `https` only."""

    async def check(session: object, context: object, request: Any) -> None:
        place = request.response.headers.get("Location", "")
        where = urlsplit(place).scheme.lower() or request.url.scheme
        if where not in {scheme, "https"}:
            raise OSError(None, f"the server sends us on to another protocol, `{where}`")

    return check


async def _check_answer(session: object, context: object, request: Any) -> None:
    """An answer to a question for a part is read as a whole: it is no longer than that part."""
    asked = _RANGE.fullmatch(request.headers.get("Range", ""))
    answer = request.response
    if asked is None or (answer.status != 206 and "Content-Range" not in answer.headers):
        return
    length = answer.content_length
    if length is None or length > int(asked[2]) - int(asked[1]) + 1:
        answer.close()
        raise OSError(None, "the server sends another part than it was asked for")
