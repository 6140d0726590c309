"""The publishers that the words of `--publish` name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack

from fretc.watch.publishing.foxglove_server import HOST, PORT, FoxgloveServer, opened
from fretc.watch.publishing.publishing import Diagnostics, Publisher
from fretc.watch.sources.source import Diagnosing, Source
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_SERVER = re.compile(r"foxglove(?::(?:(?P<host>[\w.-]+|\[[\da-fA-F:.]+\]):)?(?P<port>\d{1,5}))?")


def chosen(words: Sequence[str], source: Source) -> Sequence[Publisher] | Diagnostic:
    """An open publisher for each word; or a diagnostic, and none is open."""
    publishers: list[Publisher] = []
    with ExitStack() as stack:
        for word in dict.fromkeys(words):
            publisher = _publisher(word, source)
            if isinstance(publisher, Diagnostic):
                return publisher
            publishers.append(publisher)
            stack.callback(publisher.close)
        stack.pop_all()
    return publishers


def _publisher(word: str, source: Source) -> Publisher | Diagnostic:
    if word == "diagnostics":
        if isinstance(source, Diagnosing):
            return Diagnostics(source)
        return diagnostic("publishing_not_accepted", source=source.name)
    server = _SERVER.fullmatch(word)
    if server is None or int(server["port"] or 0) > 65535:
        return diagnostic("unknown_publisher", word=word)
    port = PORT if server["port"] is None else int(server["port"])
    return opened((server["host"] or HOST).strip("[]"), port)


def addresses(publishers: Sequence[Publisher]) -> list[str]:
    """The addresses of the servers among the publishers."""
    return [
        f"ws://{publisher.host}:{publisher.port}"
        for publisher in publishers
        if isinstance(publisher, FoxgloveServer)
    ]
