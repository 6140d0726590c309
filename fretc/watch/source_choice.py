"""The source that the words of a command name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from fretc.watch.sources.dds import Dds
from fretc.watch.sources.foxglove import Foxglove
from fretc.watch.sources.foxglove_protocol import address
from fretc.watch.sources.log import Log
from fretc.watch.sources.ros1 import Ros1
from fretc.watch.sources.source import Source
from fretc.watch.zenoh.keys import is_locator
from fretc.watch.zenoh.zenoh import LOCATOR, Zenoh
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
        most, source_of = middleware
        return source_of(*more) if len(more) <= most else _one_name_too_many(more[most])
    return _one_name_too_many(more[0]) if more else Log(name, follow=follow)


def _foxglove(text: str = "") -> Source | Diagnostic:
    url = address(text)
    return url if isinstance(url, Diagnostic) else Foxglove(url)


def _zenoh(text: str = LOCATOR) -> Source | Diagnostic:
    return Zenoh(text) if is_locator(text) else diagnostic("bad_locator", text=text)


_MIDDLEWARE: Mapping[str, tuple[int, Callable[..., Source | Diagnostic]]] = {
    "ros1": (0, Ros1),
    "dds": (0, Dds),
    "foxglove": (1, _foxglove),
    "zenoh": (1, _zenoh),
}
"""For each name of a middleware, the most words after it, and the source of these words."""


def _one_name_too_many(name: str) -> Diagnostic:
    return diagnostic("second_source", name=name)
