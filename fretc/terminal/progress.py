"""How far a command is, and at what, on standard error, where that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click


@contextmanager
def progress(length: int, label: str) -> Iterator[Callable[[int, str], None]]:
    """A bar with the time that is left, as long as the context lasts.

    Args:
        length: of the whole, in any unit.
        label: what is being done.

    Yields:
        Tells how much of the whole is done, in that unit, and the same in words.
    """
    if length <= 0 or not sys.stderr.isatty():
        yield lambda done, words: None
        return
    with click.progressbar(
        length=length, label=label, file=sys.stderr, item_show_func=lambda words: words
    ) as bar:
        yield lambda done, words: bar.update(done - bar.pos, words)


def at_work(words: str) -> None:
    """A line with what is being worked on."""
    if sys.stderr.isatty():
        click.echo(words, err=True)
