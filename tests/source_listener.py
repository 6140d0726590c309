"""A thread that listens to a source of `fretc watch`, for tests of sources."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Thread
from typing import Any, TypeVar

from fretc.watch.sources.source import Arrival, Event, Idle, Problem, Source
from fretish.diagnostics.diagnostic import Code
from tests.ros1 import until


class SourceListener:
    """A source, and what it has given."""

    def __init__(self, source: Source, *topics: str) -> None:
        self.source = source
        self.items: list[Arrival | Event] = []
        self.thread = Thread(target=self._listen, args=(topics or ("/x",),), daemon=True)
        self.thread.start()

    def _listen(self, topics: tuple[str, ...]) -> None:
        for item in self.source.arrivals(topics):
            if not isinstance(item, Idle):
                self.items.append(item)

    def of(self, kind: type) -> list[Any]:
        return [item for item in tuple(self.items) if isinstance(item, kind)]

    @property
    def codes(self) -> list[Code]:
        return [item.diagnostic.code for item in self.of(Problem)]

    @property
    def payloads(self) -> list[bytes]:
        return [item.payload for item in self.of(Arrival)]

    def wait(self, what: str, holds: Callable[[], object]) -> None:
        try:
            until(what, holds, 20)
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.items[-3:]}") from None


Listener = TypeVar("Listener", bound=SourceListener)


@contextmanager
def closed(listener: Listener) -> Iterator[Listener]:
    """The listener; at the end its source is closed, and its thread ends."""
    try:
        yield listener
    finally:
        listener.source.close()
        listener.thread.join(10)
        assert not listener.thread.is_alive()
