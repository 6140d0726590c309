"""README.md, typed from top to bottom in a copy of the clone, prints what it shows.

    $ fretc audit traces/*.mcap  # exit 1
    wrote build/evidence.json
    ...

A command exits with 0, or as its comment says. What is below it is all that it prints, but for
`...`: any text in a line, any lines as a line. A command with nothing below may print anything.
One shell runs all of them with the full profile. Else `fretc` runs in this process, and what takes
many seconds does not.
"""

from __future__ import annotations

import doctest
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from glob import glob
from pathlib import Path

import pytest

from fretc import cli
from tests.effort import FULL

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
SET_UP = re.compile(r"^    python3 -m venv .* && \.venv/bin/(fretc .*)$", re.MULTILINE)
ACTIVATE = ". .venv/bin/activate"
MARK = "end of a command:"
COSTLY = re.compile(r"fretc analyze requirements/agv|fretc simulate|fretc watch|.* mission\.mcap")
"""Beginnings of commands that take seconds, and of what reads the log that one of them makes."""


@dataclass(frozen=True)
class Step:
    """A command, and what README says of it."""

    command: str
    status: int
    shown: str
    """Lines; empty: nothing is said of what it prints."""

    def pattern(self) -> str:
        """Of all that it prints."""
        anything = {"...": "(?:.*\n)*?"}
        lines = (
            anything.get(line, re.escape(line).replace(r"\.\.\.", ".*") + "\n")
            for line in self.shown.splitlines()
        )
        return "".join(lines)


def steps(text: str) -> Iterator[Step]:
    """What the first set-up runs, and then each command after a `$`."""
    yield Step(SET_UP.findall(text)[0], 0, "")
    blocks = re.findall(r"^    \$ (.*)\n((?:(?:    (?!\$ ).*)?\n)*)", text, re.MULTILINE)
    for typed, below in blocks:
        command, _, status = typed.partition("  # exit ")
        if command != ACTIVATE:
            yield Step(
                command, int(status or 0), re.sub(r"^    ", "", below, flags=re.M).strip("\n")
            )


def pasted(commands: list[str], folder: Path) -> list[tuple[str, int]]:
    """What one shell prints for each of them, and what it exits with."""
    ends = (f"{command}\nprintf '{MARK}%s\\n' $?\n" for command in commands)
    tools = {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    shell = subprocess.run(
        ["bash"],
        input="exec 2>&1\n" + "".join(ends),
        stdout=subprocess.PIPE,
        text=True,
        cwd=folder,
        env={**os.environ, **tools, "PYTHONUNBUFFERED": "1", "XDG_STATE_HOME": str(folder)},
        check=True,
    )
    parts = re.split(rf"^{MARK}(\d+)\n", shell.stdout, flags=re.MULTILINE)
    return [(text, int(status)) for text, status in zip(parts[::2], parts[1::2], strict=False)]


def typed(command: str, folder: Path) -> tuple[str, int]:
    """The same of one of them; `fretc` runs in this process, unless a shell is needed."""
    words = shlex.split(command)
    if words[0] != "fretc" or {"|", ">"} & {*words}:
        return pasted([command], folder)[0]
    output = io.BytesIO()
    both = io.TextIOWrapper(output, encoding="utf-8", write_through=True)
    status: object = 0
    with chdir(folder), redirect_stdout(both), redirect_stderr(both):
        sys.argv = [each for word in words for each in (sorted(glob(word)) or [word])]
        try:
            cli.main()
        except SystemExit as end:
            status = end.code or 0
    return output.getvalue().decode(), int(str(status))


@pytest.mark.slow
def test_each_command_prints_what_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clone = tmp_path / "clone"
    for folder in ("requirements", "traces"):
        shutil.copytree(ROOT / folder, clone / folder)
    text = README.read_text("utf-8")
    expected = list(steps(text))
    assert len(expected) == 1 + text.count("\n    $ ") - text.count(ACTIVATE)
    monkeypatch.setattr(sys, "argv", [])
    monkeypatch.setenv("XDG_STATE_HOME", str(clone))
    if FULL:
        printed = pasted([step.command for step in expected], clone)
    else:
        expected = [step for step in expected if not COSTLY.match(step.command)]
        printed = [typed(step.command, clone) for step in expected]
    assert len(printed) == len(expected)
    for step, (output, status) in zip(expected, printed, strict=True):
        assert status == step.status, f"{step.command}\n{output}"
        if step.shown:
            shown = re.fullmatch(step.pattern(), output)
            assert shown, f"{step.command}\n{output}\nin place of\n{step.shown}"
    monkeypatch.chdir(clone)
    assert doctest.testfile(str(README), module_relative=False).failed == 0


def test_a_command_with_another_output_or_status_is_seen() -> None:
    (_, first, second) = steps(
        "    python3 -m venv .venv && .venv/bin/fretc x\n\n"
        "    $ ls  # exit 2\n    a ... c\n    ...\n      d\n\n      e\n    $ pwd\n\nand\n"
    )
    assert (first.command, first.status) == ("ls", 2)
    assert second == Step("pwd", 0, "")
    for output, is_shown in (
        ("a b c\n  d\n\n  e\n", True),
        ("a b c\nx\ny\n  d\n\n  e\n", True),
        ("a b c\n  d\n\n  e\nf\n", False),
        ("0\na b c\n  d\n\n  e\n", False),
        ("a b c d\n  d\n\n  e\n", False),
    ):
        assert bool(re.fullmatch(first.pattern(), output)) == is_shown
