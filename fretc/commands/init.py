"""`fretc init`: create a project with one requirement, its bindings and its hazards."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from shlex import quote

import click

from fretc.terminal.options import LOG_EXTRAS, PATH, extras, path_option
from fretc.terminal.output import (
    REQUIREMENTS_FOLDER,
    fail,
    or_fail,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

_CHECK = "compare topics, limits and times with your robot's"
"""What to do with the files of a pack."""


@click.command(
    epilog=extras(LOG_EXTRAS),
)
@click.argument("folder", default=".", type=PATH, metavar="[FOLDER]")
@path_option(
    "--from", "log", metavar="LOG", help="Log from which bindings and requirement are drafted."
)
@click.option(
    "--pack",
    metavar="PACK",
    help="Requirements, bindings and hazards of a kind of robot: `ardupilot`, `lerobot`, `nav2`, "
    "`px4`, `turtlebot4`, or a folder of your own.",
)
def init(folder: str, log: str | None, pack: str | None) -> None:
    """Create a project: requirements, their bindings and hazards.

    The files are written to FOLDER/requirements, which must not exist or be empty; FOLDER is
    the current folder by default. With `--from LOG`, the bindings are drafted from the log, and
    a requirement limits one of its signals, so that `fretc audit LOG` gives a verdict at
    once. `To do` marks what you must complete. With `--pack PACK`, the project begins with what
    teams require of such a robot.

    Example: fretc init my-robot --from run.mcap
    """
    from compiler.files.settings import NAME as SETTINGS

    requirements = Path(folder) / REQUIREMENTS_FOLDER
    if os.path.lexists(requirements) and not _is_empty_folder(requirements):
        fail(diagnostic("project_exists", path=str(requirements)))
    if log == "-":
        fail(diagnostic("log_read_twice"))
    if pack and log:
        fail(diagnostic("pack_and_log"))
    texts = _from_pack(pack) if pack else _starter_files(log)
    files = {requirements / name: text for name, text in texts.items()}
    if not _has_settings(Path(folder)):
        files[requirements / SETTINGS] = _settings_to_fill_in()
    write_outputs(files, [log] if log else [])
    _say_next_commands(folder, requirements, log, "replace each `To do`" if not pack else _CHECK)


def _starter_files(log: str | None) -> Mapping[str, str]:
    from fretc.audit.bindings.starter_files import from_log, without_log

    beginning = or_fail(without_log() if log is None else from_log(log))
    print_diagnostics(beginning.findings)
    return beginning.files


def _from_pack(name: str) -> Mapping[str, str]:
    from compiler.project.packs import read_pack

    texts = read_pack(name)
    if isinstance(texts, list):
        fail(*texts)
    return texts


def _say_next_commands(folder: str, requirements: Path, log: str | None, first: str) -> None:
    """Print the next commands, ready to be copied to the shell."""
    from fretc.logs.storage.log_names import shell_word

    option = "" if folder == "." else f" --requirements {quote(str(requirements))}"
    log_argument = "LOG" if log is None else shell_word(log)
    print_status(visible(f"next: {first} in {requirements}"))
    print_status(visible(f"next: `fretc check{option}` reports mistakes"))
    print_status(
        visible(f"next: `fretc audit {log_argument}{option}` checks a log against the requirements")
    )


def _has_settings(folder: Path) -> bool:
    """Whether a folder above has settings that a new file would hide."""
    from compiler.files.settings import settings

    found = settings(str(folder))
    return isinstance(found, Diagnostic) or found.tables is not None


def _settings_to_fill_in() -> str:
    """`fretc.toml` with a comment for everything that only the project owner knows."""
    from compiler.files.attribution import EXAMPLE

    table = "".join(f"# {line}\n" for line in EXAMPLE.splitlines())
    return f"# Settings. To do: say who answers for packages that are made, as for ROS.\n{table}"


def _is_empty_folder(path: Path) -> bool:
    return path.is_dir() and not any(path.iterdir())
