"""What the commands print, write and exit with."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

import click

from fretish.diagnostic import Code, Diagnostic
from fretish.rendering import render_all

SHOWN, VIOLATION, BAD, NOT_SHOWN, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit status: all shown, a violation, bad use or input, something not shown, Ctrl-C."""


def stop(*diagnostics: Diagnostic) -> NoReturn:
    """Say it and exit with 2."""
    say(diagnostics)
    raise SystemExit(BAD)


def say(diagnostics: Sequence[Diagnostic]) -> None:
    """Print them on standard error."""
    if diagnostics:
        say_line(render_all(diagnostics))


def say_line(text: str) -> None:
    """Print a line on standard error; where that cannot be, the exit status still tells."""
    with suppress(OSError):
        click.echo(text, err=True)


def deliver(files: Mapping[Path, str | bytes], protected: Iterable[str] = ()) -> None:
    """Write the texts, all or none, and name them.

    Args:
        files: where each text goes; `-` prints it.
        protected: files that are read, which no output may replace.
    """
    from compiler.files import write

    inputs = {os.path.realpath(path): path for path in protected if path != "-"}
    targets = [os.path.realpath(path) for path in files]
    for path, target in zip(files, targets, strict=True):
        if target in inputs:
            stop(not_written(str(path), f"it is `{inputs[target]}`, which is read"))
        if targets.count(target) > 1:
            stop(not_written(str(path), "two outputs would go there"))
    printed = files.get(Path("-"))
    if printed is not None:
        click.echo(printed, nl=False)
    written = {path: text for path, text in files.items() if path != Path("-")}
    wrong = write(written)
    if wrong is not None:
        stop(wrong)
    for path in written:
        say_line(f"wrote {path}")


def not_written(path: str, why: str) -> Diagnostic:
    """F905."""
    return Diagnostic(
        Code.NOT_WRITTEN, f"`{path}` cannot be written: {why}", help="name another file"
    )
