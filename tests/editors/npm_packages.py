"""The npm packages of `editors/`: copies whose dependencies npm installs once into a user cache."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from tests import programs

EDITORS = Path(__file__).parents[2] / "editors"
_OUTPUTS = shutil.ignore_patterns("node_modules", "dist", "*.vsix")


class NotInstalledError(Exception):
    """What npm has written."""


def copy(name: str, top: Path) -> Path:
    """Copy a package of `editors/` with its dependencies into a new folder.

    The running test is skipped where Node or npm is missing, or no registry answers.
    """
    programs.installed("node")
    dependencies = _installed(name, programs.installed("npm"))
    if isinstance(dependencies, str):
        programs.leave_out(f"needs the dependencies of editors/{name}: {dependencies}")
    folder = Path(mkdtemp(dir=top)) / name
    shutil.copytree(EDITORS / name, folder, ignore=_OUTPUTS)
    (folder / "node_modules").symlink_to(dependencies)
    return folder


def answer(folder: Path, script: str, question: Any) -> Any:
    """What a script of a package prints, as JSON, when it reads JSON."""
    return json.loads(run(folder, "node", script, text=json.dumps(question)))


def run(folder: Path, program: str, *arguments: str, text: str = "") -> str:
    """The output of a program in the folder of a package."""
    result = subprocess.run(
        [programs.installed(program), *arguments],
        cwd=folder,
        input=text,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@cache
def _installed(name: str, npm: str) -> Path | str:
    """The folder of the dependencies, or the reason why there is none."""
    try:
        return _install(EDITORS / name, npm)
    except NotInstalledError as error:
        return str(error)


def _install(package: Path, npm: str) -> Path:
    import fcntl  # Windows has none

    top = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fretc-tests"
    lock = package / "package-lock.json"
    place = top / f"npm-{package.name}-{hashlib.sha256(lock.read_bytes()).hexdigest()[:12]}"
    top.mkdir(parents=True, exist_ok=True)
    with place.with_suffix(".lock").open("w") as guard:
        fcntl.flock(guard, fcntl.LOCK_EX)
        if not place.is_dir():
            partial = place.with_suffix(".partial")  # what a killed run has left is made again
            shutil.rmtree(partial, ignore_errors=True)
            partial.mkdir()
            for file in ("package.json", "package-lock.json"):
                shutil.copy(package / file, partial)
            command = [
                npm,
                "ci",
                "--ignore-scripts",
                "--no-audit",
                "--no-fund",
                "--fetch-retries=1",
            ]
            result = subprocess.run(
                command, cwd=partial, capture_output=True, text=True, check=False
            )
            if result.returncode:
                shutil.rmtree(partial)
                raise NotInstalledError(result.stderr[-300:])
            partial.rename(place)
    return place / "node_modules"
