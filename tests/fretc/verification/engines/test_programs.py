"""Programs with limits: they end, and nothing of them is left."""

import sys
import time
from pathlib import Path

import pytest

from fretc.verification.engines.programs import run

MEMORY = 2**30


def test_both_streams_and_the_exit_status_are_told(tmp_path: Path) -> None:
    code = "import sys; print('a', flush=True); print('b', file=sys.stderr); sys.exit(3)"
    ran = run([sys.executable, "-c", code], tmp_path, seconds=20, memory=MEMORY)
    assert (ran.status, ran.text) == (3, "a\nb\n")


def test_a_program_that_takes_too_long_is_stopped_with_its_children(tmp_path: Path) -> None:
    code = (
        "import subprocess, sys, time\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        "print(child.pid, flush=True)\n"
        "time.sleep(60)\n"
    )
    ran = run([sys.executable, "-c", code], tmp_path, seconds=1, memory=MEMORY)
    assert ran.status is None
    stat = Path(f"/proc/{int(ran.text)}/stat")
    for _ in range(50):
        if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.1)
    pytest.fail("the child of the program lives on")


def test_a_program_that_takes_too_much_memory_fails(tmp_path: Path) -> None:
    code = "x = bytearray(2**30); print(len(x))"
    ran = run([sys.executable, "-c", code], tmp_path, seconds=20, memory=2**28)
    assert ran.status != 0
    assert "MemoryError" in ran.text


@pytest.mark.slow
def test_endless_output_ends(tmp_path: Path) -> None:
    ran = run(["/bin/sh", "-c", "exec yes"], tmp_path, seconds=20, memory=MEMORY)
    assert ran.status not in (0, None)
    assert len(ran.text) <= 32 * 2**20


def test_no_shell_reads_the_arguments(tmp_path: Path) -> None:
    ran = run(["/bin/echo", "$HOME `id`; x"], tmp_path, seconds=20, memory=MEMORY)
    assert ran.text == "$HOME `id`; x\n"
