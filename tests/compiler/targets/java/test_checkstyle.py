"""Checkstyle finds nothing in what is written in Java, by the checks in `checkstyle.xml`."""

from __future__ import annotations

import subprocess
from pathlib import Path

from compiler.project.folder import load
from compiler.targets.java.monitor import TARGET
from compiler.targets.target import TargetOptions
from fretc.testing.exports.files import SuiteFormat
from tests.compiler.targets.c.test_c_monitor import of_requirements
from tests.effort import full_only
from tests.fretc.testing.exports.test_files import written
from tests.java_monitors import emitted, write
from tests.programs import installed

CHECKS = Path(__file__).with_name("checkstyle.xml")
ROOT = Path(__file__).parents[4]


def complaints(folder: Path) -> list[str]:
    """The lines of its report about files."""
    files = sorted(str(path) for path in folder.rglob("*.java"))
    command = [installed("checkstyle"), "-c", str(CHECKS), *files]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "Audit done." in done.stdout, done.stderr
    return [line for line in done.stdout.splitlines() if line.startswith("[")]


@full_only("half a minute")
def test_checkstyle_finds_nothing(tmp_path: Path) -> None:
    """In monitors of each form, in samples and in a self-test."""
    written(tmp_path, SuiteFormat.JAVA, "whenever p the sw shall within 3 ticks satisfy q")
    write(tmp_path, emitted(*of_requirements()))
    for project in ("", "mission", "agv"):
        folder = ROOT / "requirements" / project
        requirements = load([str(path) for path in sorted(folder.glob("*.fret"))]).formalized
        files = TARGET.emit(requirements, TargetOptions(one_file=project == "agv"))
        write(tmp_path, {f"{project}/{file.path}": file.text for file in files})
    text = (tmp_path / "R1Monitor.java").read_text("utf-8")
    wrong = text.replace("if (certain.failed) {", "if(certain.failed) {")
    write(tmp_path, {"wrong/R1Monitor.java": wrong})
    (complaint,) = complaints(tmp_path)
    assert "wrong/R1Monitor.java:" in complaint
