"""Neovim with the configuration that we ship, and the real server."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests import programs
from tests.command import write
from tests.fretc.report import cases

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
WRONG = cases.R1.replace("shall", "shal").replace("Stop when", "\U0001f600 Stop when")


def test_a_person_fixes_hovers_and_renames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    editor = programs.installed("nvim")
    monkeypatch.chdir(tmp_path)
    write("fretc.toml", "")
    write("requirements/r1.fret", WRONG)
    write("requirements/bindings.toml", cases.BINDINGS)
    write("requirements/hazards.toml", cases.HAZARDS)
    server = tmp_path / "bin" / "fretc"
    server.parent.mkdir()
    server.write_text(f"#!{sys.executable} -P\nfrom fretc.cli import main\nmain()\n")
    server.chmod(0o755)
    configuration, session = ROOT / "editors/nvim/fretc.lua", ROOT / "tests/editors/session.lua"
    done = subprocess.run(
        [editor, "--headless", "-n", "-u", str(configuration), "-S", str(session)],
        env={
            **os.environ,
            "PATH": f"{server.parent}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(ROOT),
            **{f"XDG_{kind}_HOME": str(tmp_path / kind) for kind in ("CONFIG", "DATA", "STATE")},
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    answers = json.loads(done.stdout)
    assert "error" not in answers, answers
    assert answers["filetype"] == "fretish"
    assert os.path.realpath(answers["root"]) == os.path.realpath(tmp_path)
    assert "F107" in answers["before"]
    assert "\n".join([*answers["fixed"], ""]) == WRONG.replace("shal ", "shall ")
    assert answers["hover"].startswith("**`near`**\n\nproposition, input: `clearance < 5 cm`")
    assert answers["renamed"][-1] == "whenever too_near the robot shall eventually satisfy stopped"
    assert "[proposition.too_near]" in Path("requirements/bindings.toml").read_text()
