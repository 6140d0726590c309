"""Where Spot is not installed, every command works, or says that it needs Spot."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from tests.effort import full_only
from tests.plain_installation import lines

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
REMEDY = "install Spot: `pip install spottl`"
NEEDED = {
    ("compile", "requirements/r1.fret", "-o", "build", "--emit", "agent-runtime"): 2,
    ("compile", "requirements/r1.fret", "-o", "build", "--emit", "ajpf-bundle"): 2,
    ("verify", "requirements/r1.fret", "--monitor", "--layer", "loop"): 3,
    ("verify", "requirements/r1.fret", "--monitor", "--layer", "agent"): 3,
}
"""The lines that need Spot, and their exit status."""
Done = dict[str, Any]


def left_out() -> list[tuple[str, ...]]:
    """All but the first line of each command, all kinds of `--emit`, and all layers of proofs."""
    known, others = set[str](), list[tuple[str, ...]]()
    for words in lines():
        if words[0] in known and "--layer" not in words and words[0] != "compile":
            others.append(words)
        known.add(words[0])
    return others


def ran(folder: Path, *, has_spot: bool) -> list[Done]:
    """The lines in one process, whose own processes find no Spot either."""
    folder.mkdir()
    if not has_spot:
        (folder / "spot.py").write_text("raise ModuleNotFoundError('hidden by a test')\n")
    hidden = [] if has_spot else ["spottl"]
    setting = {"packages": [], "distributions": hidden, "left_out": left_out()}
    (folder / "setting.json").write_text(json.dumps(setting))
    program = ROOT / "tests/plain_installation.py"
    done = subprocess.run(
        [sys.executable, str(program), str(ROOT), str(folder / "setting.json")],
        env={"PYTHONPATH": os.pathsep.join([str(folder), str(ROOT)]), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> list[Done]:
    return ran(tmp_path_factory.mktemp("bare") / "folder", has_spot=False)


def test_only_model_checking_needs_spot_and_says_how_to_install_it(bare: Sequence[Done]) -> None:
    found = {tuple(done["words"]): done for done in bare if REMEDY in done["out"] + done["err"]}
    assert {words: done["status"] for words, done in found.items()} == NEEDED
    for done in found.values():
        assert "F908" in done["out"] + done["err"]


@full_only("all lines a second time")
def test_no_other_answer_depends_on_spot(bare: Sequence[Done], tmp_path: Path) -> None:
    from tests.test_plain_installation import untimed

    whole = ran(tmp_path / "whole", has_spot=True)
    for without, with_spot in zip(bare, whole, strict=True):
        if tuple(without["words"]) not in NEEDED and without["words"][0] != "sbom":
            assert untimed(without) == untimed(with_spot), without["words"]
