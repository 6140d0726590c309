"""Progress of a command on standard error, if that is a terminal."""

from __future__ import annotations

import shutil
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
    columns = shutil.get_terminal_size().columns - len(label) - _BAR - _TIMES
    with click.progressbar(
        length=length,
        label=label,
        width=_BAR,
        file=sys.stderr,
        item_show_func=lambda words: words and shortened(words, columns),
    ) as bar:
        yield lambda done, words: bar.update(done - bar.pos, words)


_BAR = 20
_TIMES = 24
"""Columns of the frame of a bar, its share and the remaining time."""


def shortened(words: str, columns: int) -> str:
    """The words, cut so that the bar stays on one line."""
    return words if len(words) <= columns else f"{words[: max(columns - 1, 0)]}…"


def print_activity(words: str) -> None:
    """Print the current activity."""
    if sys.stderr.isatty():
        click.echo(words, err=True)
