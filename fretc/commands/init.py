"""The command that begins a project."""

from __future__ import annotations

import os
from pathlib import Path
from shlex import quote

import click

from fretc.terminal.options import PATH, path_option
from fretc.terminal.output import FOLDER, deliver, say, say_line, stop
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import visible


@click.command(short_help="Begin a project: one requirement, its bindings and hazards.")
@click.argument("folder", default=".", type=PATH, metavar="[FOLDER]")
@path_option("--from", "log", metavar="LOG", help="Draft bindings and requirement from this log.")
def init(folder: str, log: str | None) -> None:
    """Begin a project: one requirement, its bindings and hazards.

    They go to FOLDER/requirements, which must not be there yet, or be empty; FOLDER is the present
    one if not given. With `--from LOG` the bindings are those that `fretc bind --from LOG` drafts,
    and the requirement bounds a signal of the log, so that `fretc audit LOG` can judge it at once.
    What is yours to say is marked `To do`.
    """
    from fretc.audit.bindings.beginning import from_log, without_log

    place = Path(folder) / FOLDER
    if os.path.lexists(place) and not _is_empty(place):
        stop(_exists(str(place)))
    if log == "-":
        stop(_twice())
    beginning = without_log() if log is None else from_log(log)
    if isinstance(beginning, Diagnostic):
        stop(beginning)
    say(beginning.findings)
    deliver({place / name: text for name, text in beginning.files.items()}, [log] if log else [])
    where = "" if folder == "." else f" --requirements {quote(str(place))}"
    say_line(visible(f"next: `fretc check{where}` says what is wrong or missing"))
    run = "LOG" if log is None else quote(log)
    say_line(visible(f"next: `fretc audit {run}{where}` judges a log"))


def _is_empty(place: Path) -> bool:
    return place.is_dir() and not any(place.iterdir())


def _exists(place: str) -> Diagnostic:
    return Diagnostic(
        Code.NOT_WRITTEN,
        f"`{place}` is there already",
        help="name another folder; `fretc bind --from LOG` drafts bindings alone",
    )


def _twice() -> Diagnostic:
    return Diagnostic(
        Code.BAD_USAGE,
        "standard input can be read once, and a project is drafted from a log in two readings",
        help="save the log as a file, and name that",
    )
