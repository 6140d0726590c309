"""Reading from web servers, with limits on time and on the answers.

The only module that imports aiohttp, which fsspec uses for `http` and `https`.
"""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

SCHEMES = frozenset({"http", "https"})
PATIENCE, SLOWEST = 60, 10_000
"""Seconds after which a server must have sent so many bytes a second."""
BLOCK = 2**22
"""Bytes of one request."""
_CONNECT = 30
"""Seconds for a connection."""
_RANGE = re.compile(r"bytes=(\d+)-(\d+)")


def is_web(url: str) -> bool:
    """Whether a web server is needed for the path."""
    return urlsplit(url).scheme.lower() in SCHEMES


def options(url: str) -> dict[str, Any]:
    """The options of fsspec for a URL; empty: it is not on a web server."""
    if not is_web(url):
        return {}
    return {"get_client": _only_safe if urlsplit(url).scheme.lower() == "https" else _any}


async def _only_safe(**arguments: Any) -> Any:
    return _client("https", **arguments)


async def _any(**arguments: Any) -> Any:
    return _client("http", **arguments)


def _client(scheme: str, **arguments: Any) -> Any:
    """A session that unpacks nothing, because unpacked data could have any size.

    A server that sends a byte now and then is never silent: so the whole answer has a time limit,
    too.
    """
    import aiohttp

    hooks = aiohttp.TraceConfig()
    hooks.on_request_redirect.append(_redirects(scheme))
    hooks.on_request_end.append(_check_answer)
    longest = PATIENCE + BLOCK / SLOWEST
    limits = aiohttp.ClientTimeout(total=longest, sock_connect=_CONNECT, sock_read=PATIENCE)
    return aiohttp.ClientSession(
        trace_configs=[hooks], timeout=limits, auto_decompress=False, **arguments
    )


class WebStream:
    """The bytes at a URL, in pieces as they arrive; each has to arrive within `PATIENCE`."""

    def __init__(self, system: Any, url: str) -> None:
        self._loop = system.loop
        self._answer = self._wait(_answer, system, url)

    def read(self, length: int) -> bytes:
        """The bytes that have arrived, at most so many."""
        return bytes(self._wait(self._answer.content.read, length))

    def close(self) -> None:
        """Close the connection."""
        self._loop.call_soon_threadsafe(self._answer.close)

    def _wait(self, ask: Any, *arguments: object) -> Any:
        import asyncio  # imported late, because most logs are files

        future = asyncio.run_coroutine_threadsafe(ask(*arguments), self._loop)
        try:
            return future.result(PATIENCE)
        finally:
            future.cancel()


async def _answer(system: Any, url: str) -> Any:
    """The response of a server to a request for all of it, before its body."""
    import aiohttp

    session = await system.set_session()
    endless = aiohttp.ClientTimeout(total=None, sock_connect=_CONNECT, sock_read=PATIENCE)
    answer = await session.get(system.encode_url(url), timeout=endless)
    answer.raise_for_status()
    return answer


def _redirects(scheme: str) -> Any:
    """Check a redirect: from `https` only to `https`."""

    async def check(session: object, context: object, request: Any) -> None:
        location = request.response.headers.get("Location", "")
        where = urlsplit(location).scheme.lower() or request.url.scheme
        if where not in {scheme, "https"}:
            raise OSError(None, f"the server redirects to another protocol, `{where}`")

    return check


async def _check_answer(session: object, context: object, request: Any) -> None:
    """Refuse an answer that is longer than the requested part: it would be read as a whole."""
    part = _RANGE.fullmatch(request.headers.get("Range", ""))
    answer = request.response
    if part is None or (answer.status != 206 and "Content-Range" not in answer.headers):
        return
    length = answer.content_length
    if length is None or length > int(part[2]) - int(part[1]) + 1:
        answer.close()
        raise OSError(None, "the server sent another byte range than requested")
