"""The words of `--publish` → where verdicts go."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack

from fretc.watch.publishing.foxglove_server import HOST, PORT, FoxgloveServer, opened
from fretc.watch.publishing.publishing import Diagnostics, Publisher
from fretc.watch.sources.source import Diagnosing, Source
from fretish.diagnostics.diagnostic import Code, Diagnostic

_SERVER = re.compile(r"foxglove(?::(?:(?P<host>[\w.-]+|\[[\da-fA-F:.]+\]):)?(?P<port>\d{1,5}))?")


def chosen(words: Sequence[str], source: Source) -> Sequence[Publisher] | Diagnostic:
    """One for each word, open; or what is wrong, and none is open."""
    publishers: list[Publisher] = []
    with ExitStack() as stack:
        for word in dict.fromkeys(words):
            found = _publisher(word, source)
            if isinstance(found, Diagnostic):
                return found
            publishers.append(found)
            stack.callback(found.close)
        stack.pop_all()
    return publishers


def _publisher(word: str, source: Source) -> Publisher | Diagnostic:
    if word == "diagnostics":
        if isinstance(source, Diagnosing):
            return Diagnostics(source)
        return Diagnostic(
            Code.BAD_USAGE,
            f"`--publish diagnostics` publishes on the watched middleware, and `{source.name}` "
            "accepts none",
            help="watch `dds` or `ros1`; or publish to Foxglove: `--publish foxglove`",
        )
    server = _SERVER.fullmatch(word)
    if server is None or int(server["port"] or 0) > 65535:
        return Diagnostic(
            Code.BAD_USAGE,
            f"nothing can be published to `{word}`",
            help="write `diagnostics`, `foxglove`, `foxglove:PORT` or `foxglove:HOST:PORT`",
        )
    port = PORT if server["port"] is None else int(server["port"])
    return opened((server["host"] or HOST).strip("[]"), port)


def addresses(publishers: Sequence[Publisher]) -> list[str]:
    """Where people find the servers among them."""
    return [
        f"ws://{each.host}:{each.port}" for each in publishers if isinstance(each, FoxgloveServer)
    ]
