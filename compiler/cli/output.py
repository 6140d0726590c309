"""What the commands print, write and exit with."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from fretish.diagnostic import Code, Diagnostic
from fretish.rendering import render_all

SHOWN, VIOLATION, BAD, NOT_SHOWN, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit status: all shown, a violation, bad use or input, something not shown, Ctrl-C."""


def stop(*diagnostics: Diagnostic) -> None:
    """Say it and exit with 2."""
    say(diagnostics)
    raise SystemExit(BAD)


def say(diagnostics: Sequence[Diagnostic]) -> None:
    """Print them on standard error."""
    if diagnostics:
        click.echo(render_all(diagnostics), err=True)


def deliver(files: dict[str, str], output: str) -> None:
    """Print the texts (`-`), or write them below the folder and name them."""
    from pathlib import PurePosixPath

    from compiler.artifact import Artifact
    from compiler.files import write

    if output == "-":
        click.echo("".join(files.values()), nl=False)
        return
    artifacts = [Artifact(PurePosixPath(path), text) for path, text in files.items()]
    wrong = write(artifacts, Path(output))
    if wrong is not None:
        stop(wrong)
    for path in files:
        click.echo(f"wrote {Path(output) / path}", err=True)


def not_written(path: str, why: str) -> Diagnostic:
    """F905."""
    return Diagnostic(
        Code.NOT_WRITTEN, f"`{path}` cannot be written: {why}", help="name another file"
    )
