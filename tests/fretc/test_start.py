"""Ctrl-C before the command is up says one line, and the end of a command is no work."""

import subprocess
import sys
from pathlib import Path

import pytest

INTERRUPTED = """
import os, signal, sys
from fretc.start import main

class Finder:
    left = {left}

    def find_spec(self, name, path=None, target=None):
        self.left -= 1
        if not self.left:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Finder())
main()
"""
"""Ctrl-C while the module of this number is imported."""


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 2, 60, 200])
def test_an_interruption_while_modules_are_imported(number: int, tmp_path: Path) -> None:
    sentence = tmp_path / "r1.fret"
    sentence.write_text("agilex_agent shall always satisfy stopped\n", encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-c", INTERRUPTED.format(left=number), str(sentence), "--emit", "monitor"],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "stopped\n")


FROZEN = """
import atexit, gc, sys

def count():
    gc.collect()
    print(gc.get_freeze_count() > 10_000, len(gc.get_objects()) < 1_000)

atexit.register(count)
from fretc.start import main
main()
"""
"""Prints whether Python has objects to search at its end."""


@pytest.mark.slow
def test_python_searches_no_object_when_a_command_has_ended() -> None:
    run = subprocess.run(
        [sys.executable, "-c", FROZEN, "--version"],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (run.returncode, run.stdout.splitlines()[-1]) == (0, "True True")
