"""Progress of a command on standard error, if that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click


@contextmanager
def progress(length: int, label: str) -> Iterator[Callable[[int, str], None]]:
    """Progress bar with the remaining time, for the duration of the context.

    Args:
        length: the total, in any unit.
        label: the name of the activity.

    Yields:
        A function of the finished amount, in that unit, and a text.
    """
    if length <= 0 or not sys.stderr.isatty():
        yield lambda done, words: None
        return
    with click.progressbar(
        length=length, label=label, file=sys.stderr, item_show_func=lambda words: words
    ) as bar:
        yield lambda done, words: bar.update(done - bar.pos, words)


def print_activity(words: str) -> None:
    """Print the current activity."""
    if sys.stderr.isatty():
        click.echo(words, err=True)
