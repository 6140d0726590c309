"""The source that the words of a command name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from fretc.watch.sources.dds import Dds
from fretc.watch.sources.foxglove import Foxglove
from fretc.watch.sources.foxglove_protocol import address
from fretc.watch.sources.log import Log
from fretc.watch.sources.ros1 import Ros1
from fretc.watch.sources.source import Source
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic


def chosen(words: Sequence[str], *, follow: bool) -> Source | Diagnostic:
    """The source, not yet opened; or a diagnostic about the words.

    Args:
        words: the name of a middleware and its arguments, or the path of a log.
        follow: whether to wait for further messages of a log that is being written.
    """
    name, *more = words
    middleware = _MIDDLEWARE.get(name)
    if middleware is not None and follow:
        return diagnostic("follow_needs_log", name=name)
    if middleware is not None:
        return middleware(more)
    return diagnostic("second_source", name=more[0]) if more else Log(name, follow=follow)


def _ros1(more: Sequence[str]) -> Source | Diagnostic:
    return diagnostic("second_source", name=more[0]) if more else Ros1()


def _dds(more: Sequence[str]) -> Source | Diagnostic:
    return diagnostic("second_source", name=more[0]) if more else Dds()


def _foxglove(more: Sequence[str]) -> Source | Diagnostic:
    if len(more) > 1:
        return diagnostic("second_source", name=more[1])
    url = address("".join(more))
    return url if isinstance(url, Diagnostic) else Foxglove(url)


_MIDDLEWARE: Mapping[str, Callable[[Sequence[str]], Source | Diagnostic]] = {
    "ros1": _ros1,
    "dds": _dds,
    "foxglove": _foxglove,
}
"""For each name of a middleware, the parser of the words after it."""
