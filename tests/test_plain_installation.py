"""What a plain installation does: all that needs no extra, and the extra is named by the rest.

By default each command with the first of what its options take; `.ci/run` tries the rest, too.
"""

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from functools import cache
from importlib.metadata import distribution, packages_distributions
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from fretc.cli import cli
from tests.effort import FULL
from tests.plain_installation import LINES, lines

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OF_DEVELOPERS = {"dev", "peers", "prose"}
EXTRAS = PROJECT["optional-dependencies"].keys() - OF_DEVELOPERS
Done = dict[str, Any]


def always_installed() -> set[str]:
    """The distributions that fretc needs, with what these need."""
    found = {"fretc"}
    waiting = [Requirement(text) for text in PROJECT["dependencies"]]
    while waiting:
        needed = waiting.pop()
        extras = ("", *needed.extras)
        if needed.marker is None or any(needed.marker.evaluate({"extra": e}) for e in extras):
            name = canonicalize_name(needed.name)
            if name not in found:
                found.add(name)
                waiting += map(Requirement, distribution(name).requires or ())
    return found


def hidden() -> dict[str, list[str]]:
    """All else that is installed here."""
    kept = always_installed()
    owners = {
        package: {canonicalize_name(each) for each in names}
        for package, names in packages_distributions().items()
    }
    return {
        "packages": sorted(package for package, names in owners.items() if not names & kept),
        "distributions": sorted(set[str]().union(*owners.values()) - kept),
    }


def ran(setting: dict[str, Any], folder: Path) -> list[Done]:
    path = folder / "setting.json"
    path.write_text(json.dumps(setting))
    program = ROOT / "tests/plain_installation.py"
    done = subprocess.run(
        [sys.executable, str(program), str(ROOT), str(path)],
        env={"PYTHONPATH": str(ROOT), "PATH": "", "PYTHONHASHSEED": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


CHOICES = [words for words in lines() if words not in LINES and words[-1] not in EXTRAS]
UNTRIED = [] if FULL else CHOICES


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> list[Done]:
    return ran({**hidden(), "left_out": UNTRIED}, tmp_path_factory.mktemp("plain"))


@cache
def help_of(command: str) -> str:
    import click

    text = cli.commands[command].get_help(click.Context(cli.commands[command]))
    return " ".join(text.partition("Optional packages ")[2].split())


def extra_of(done: Done) -> str | None:
    """The one that its messages name."""
    found = re.search(r"fretc\[(\w+)\]", done["out"] + done["err"])
    return found and found[1]


def test_each_extra_is_named_where_it_is_missing_and_by_the_help(plain: Sequence[Done]) -> None:
    found = {extra: done["words"] for done in plain if (extra := extra_of(done)) is not None}
    assert found.keys() == EXTRAS
    for done in plain:
        extra = extra_of(done)
        if extra is not None:
            assert f"`{extra}` for " in help_of(done["words"][0]), done["words"]
            assert "F908" in done["err"] or "not checked" in done["out"]


def test_no_answer_depends_on_an_extra(plain: list[Done], tmp_path: Path) -> None:
    """The same output, the same files, byte for byte."""
    left_out = [*UNTRIED, *(done["words"] for done in plain if extra_of(done) is not None)]
    whole = ran({"packages": [], "distributions": [], "left_out": left_out}, tmp_path)
    expected = [done for done in plain if extra_of(done) is None]
    for before, after in zip(expected, whole, strict=True):
        assert untimed(before) == untimed(after), before["words"]


TIMED = re.compile(r"(^| )analysis\.(json|answers)$|/evidence\.sqlite$")
"""Files that hold when, where, or in what time, they were made: a store knows logs by their times,
and answers are kept for their folder and the libraries that gave them."""


def untimed(done: Done) -> Done:
    """Without the time that it took."""
    out = re.sub(r"\d+\.\d+ (m?s)\b|(?<=\"seconds\": )[\d.e-]+", r"0 \1", done["out"])
    files = {name: text for name, text in done["files"].items() if not TIMED.search(name)}
    return {**done, "out": out, "files": files}
