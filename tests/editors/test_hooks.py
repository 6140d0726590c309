"""The hooks for pre-commit: pre-commit accepts the manifest, and the entries are commands."""

import re
import shlex
from pathlib import Path

import yaml
from pre_commit.clientlib import load_manifest  # type: ignore[import-untyped]

from tests.command import Fretc, write
from tests.fretc.report import cases

MANIFEST = Path(__file__).parents[2] / ".pre-commit-hooks.yaml"
HOOKS = {hook["id"]: hook for hook in yaml.safe_load(MANIFEST.read_text(encoding="utf-8"))}


def test_pre_commit_accepts_the_manifest() -> None:
    assert [hook["id"] for hook in load_manifest(str(MANIFEST))] == ["fretc-check", "fretc-fmt"]


def test_a_commit_is_checked_where_it_touches_a_project(fretc: Fretc) -> None:
    files = re.compile(HOOKS["fretc-check"]["files"])
    for name in ("r1.fret", "bindings.toml", "hazards.toml", "waivers.toml", "fretc.lock"):
        assert files.search(f"requirements/{name}")
    assert files.search("fretc.toml")
    assert not files.search("pyproject.toml")
    write("requirements/r1.fret", "the robot shal satisfy near\n")
    _, *words = shlex.split(HOOKS["fretc-check"]["entry"])
    assert fretc(*words).status == 2


def test_a_commit_is_formatted(fretc: Fretc) -> None:
    write("requirements/r1.fret", cases.R1.replace("whenever near", "Whenever   near"))
    _, *words = shlex.split(HOOKS["fretc-fmt"]["entry"])
    assert fretc(*words, "requirements/r1.fret").status == 0
    assert Path("requirements/r1.fret").read_text() == cases.R1
