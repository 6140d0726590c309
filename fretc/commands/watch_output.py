"""Output of `fretc watch`: a screen, lines of text, or lines of JSON."""

from __future__ import annotations

import json
import signal
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from threading import Event as Flag
from types import FrameType
from typing import Protocol

import click

from fretc.terminal.output import coloured, painted, print_diagnostics
from fretc.terminal.screen import screen
from fretc.watch.events import DiagnosticEvent, StateChange, WatchEvent
from fretc.watch.json_lines import line as json_line
from fretc.watch.publishing.publishing import Publishing
from fretc.watch.reaction import Reaction
from fretc.watch.session import Session
from fretc.watch.sources.source import Source
from fretc.watch.text_output import line, rows
from fretc.watch.watch import Watch
from fretish.diagnostics.rendering import visible

_PERIOD = 0.2
"""Seconds between two updates of the screen."""


class Output(Protocol):
    """Output of a watch."""

    def tell(self, news: WatchEvent, session: Session) -> None:
        """Show an event."""

    def refresh(self, session: Session) -> None:
        """Update the output after some time."""

    def end(self, session: Session) -> None:
        """End the output."""


class JsonLines:
    """JSON lines: an object for each event."""

    def tell(self, news: WatchEvent, session: Session) -> None:
        """Print the event as a line, at once."""
        click.echo(json.dumps(json_line(news), sort_keys=True))
        sys.stdout.flush()

    def refresh(self, session: Session) -> None:
        """Nothing: only events are printed."""

    def end(self, session: Session) -> None:
        """Nothing."""


class Lines:
    """Text lines: a line for each event, without a terminal."""

    def __init__(self) -> None:
        self._start: int | None = None

    def tell(self, news: WatchEvent, session: Session) -> None:
        """Print the event."""
        self._start = self._start if self._start is not None else session.first_tick
        if isinstance(news, DiagnosticEvent):
            print_diagnostics([news.diagnostic])
            return
        text = line(news, self._start)
        if text is not None:
            click.echo(coloured([(visible(text), None)]), nl=False)
            sys.stdout.flush()

    def refresh(self, session: Session) -> None:
        """Nothing: only events are printed."""

    def end(self, session: Session) -> None:
        """Nothing."""


class Board:
    """Screen with a row for each requirement below the scrolling events."""

    def __init__(self, titles: Mapping[str, str]) -> None:
        """An empty screen; `titles` are those of the requirements."""
        self._titles, self._lines = titles, Lines()
        self._height, self._drawn = 0, 0.0

    def tell(self, news: WatchEvent, session: Session) -> None:
        """Print an event above the rows; changes that the rows show are not printed."""
        if isinstance(news, StateChange) and news.before is None:
            return
        self._clear()
        self._lines.tell(news, session)

    def refresh(self, session: Session) -> None:
        """Draw the rows, if an update is due."""
        if time.monotonic() - self._drawn >= _PERIOD:
            self._draw(session)

    def end(self, session: Session) -> None:
        """Leave the final rows on the screen."""
        self._draw(session)
        self._height = 0

    def _draw(self, session: Session) -> None:
        drawn = list(rows(session, self._titles, screen()))
        self._clear()
        click.echo(painted(drawn), nl=False)
        sys.stdout.flush()
        self._height, self._drawn = len(drawn), time.monotonic()

    def _clear(self) -> None:
        if self._height:
            click.echo(f"\x1b[{self._height}F\x1b[J", nl=False)
            self._height = 0


def outputs_of(output_format: str, titles: Mapping[str, str]) -> Output:
    """The outputs of a watch."""
    if output_format == "jsonl":
        return JsonLines()
    return Board(titles) if sys.stdout.isatty() else Lines()


@contextmanager
def until_stopped() -> Iterator[Flag]:
    """Yield a flag that Ctrl-C and SIGTERM set, so that the current work is finished.

    A second Ctrl-C interrupts at once.
    """
    flag = Flag()

    def stop(number: int, frame: FrameType | None) -> None:
        if flag.is_set() and number == signal.SIGINT:
            raise KeyboardInterrupt
        flag.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield flag
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def watched(
    watch: Watch,
    source: Source,
    output: Output,
    reaction: Reaction | None,
    publishing: Publishing,
    stopped: Flag,
) -> None:
    """Watch until the source ends or the user stops it; then the recording is complete.

    Raises:
        OSError: standard output was closed.
    """
    with ExitStack() as stack:
        if reaction is not None:
            stack.callback(reaction.end)
        broken: OSError | None = None
        try:
            for item in source.arrivals(watch.topics):
                for news in watch.take(item):
                    _tell(news, watch, output, reaction)
                publishing.take(item, watch)
                if reaction is not None:
                    for problem in reaction.problems():
                        output.tell(DiagnosticEvent(problem), watch.session)
                output.refresh(watch.session)
                if watch.ended or stopped.is_set():
                    break
        except OSError as error:
            broken = error
        finally:
            source.close()
            for news in watch.finish():
                with suppress(OSError) if broken is not None else nullcontext():
                    _tell(news, watch, output, reaction)
            publishing.end(watch)
        if broken is not None:
            raise broken
        output.end(watch.session)
        if reaction is not None:
            reaction.wait()
            for problem in reaction.problems():
                output.tell(DiagnosticEvent(problem), watch.session)


def _tell(news: WatchEvent, watch: Watch, output: Output, reaction: Reaction | None) -> None:
    if reaction is not None and isinstance(news, StateChange) and _is_violation(news):
        reaction.start(json_line(news))
    output.tell(news, watch.session)


def _is_violation(news: StateChange) -> bool:
    before = None if news.before is None else news.before.verdict
    return news.state.verdict == "violated" and before != "violated"
