"""Whatever a program does, it ends with its run, and what is wrong has a code."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fretc.testing.conformance.program import LONGEST_LINE, ProgramError, ProgramRun
from monitors.kernel.variables import Variable
from tests.each import each

OUTPUTS = {"x": Variable("x", "truth"), "speed": Variable("speed", "number")}
START = (
    "import os, sys, time\nsay = lambda text: print(text, flush=True)\nread = sys.stdin.readline\n"
)
ECHO = 'read(); say("speed,x")\nwhile row := read(): say(row.strip())\n'

WRONG = {
    "F941 there is no column `speed`": 'say("x"); read(); read(); say("1"); read()',
    "F941 `fast`": 'say("x,speed"); read(); read(); say("1,fast"); read()',
    "F941 values": 'say("x,speed"); read(); read(); say("1"); read()',
    "F941 longer": f'say("x" * {2 * LONGEST_LINE}); time.sleep(60)',
    "F942 within": "time.sleep(60)",
    "F942 no line": 'say("x,speed"); time.sleep(60)',
    "F943 status 3; its last output: boom": 'print("boom", file=sys.stderr); sys.exit(3)',
    "F943 status 0": 'read(); say("x,speed"); read()',
    "F943 signal 9": 'say("x,speed"); read(); read(); os.kill(os.getpid(), 9)',
    "F943 closed": "os.close(1); time.sleep(60)",
}
"""Code and a word of the message, and what a program does."""


def started(text: str, seconds: float = 20) -> ProgramRun:
    return ProgramRun(
        [sys.executable, "-ISE", "-c", START + text], ("speed", "x"), OUTPUTS, seconds
    )


def steps(program: ProgramRun, ticks: int) -> None:
    with program:
        for _ in range(ticks):
            program.step([1, True])


def test_a_line_goes_in_and_a_line_comes_out() -> None:
    with started(ECHO) as program:
        assert program.step([1.5, True]) == (True, 1.5)
        assert program.step([None, False]) == (False, None)
        assert program.step([-3, None]) == (None, -3)


@pytest.mark.slow
@each("expected", WRONG)
def test_what_is_wrong_has_a_code(expected: str) -> None:
    code, _, word = expected.partition(" ")
    with pytest.raises(ProgramError) as caught:
        steps(started(WRONG[expected], 20 if code != "F942" else 0.3), 3)
    diagnostic = caught.value.diagnostic
    assert diagnostic.code.number == code
    assert word in diagnostic.message, diagnostic.message
    assert diagnostic.help


def test_a_line_too_many_is_seen() -> None:
    text = 'read(); say("x,speed")\nwhile read(): say("1,2\\n1,2")\n'
    with pytest.raises(ProgramError, match="before the inputs"):
        steps(started(text), 100)


def test_a_command_that_is_none_has_a_code(tmp_path: Path) -> None:
    for command in ([str(tmp_path / "none")], [str(tmp_path)], ["\0"]):
        with pytest.raises(ProgramError) as caught, ProgramRun(command, (), OUTPUTS, 1):
            pass
        assert caught.value.diagnostic.code.number == "F940"


def test_its_children_end_with_it(tmp_path: Path) -> None:
    path = tmp_path / "child"
    text = f"""
import subprocess
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
open({str(path)!r}, "w").write(str(child.pid))
{ECHO}"""
    with started(text) as program:
        program.step([1, True])
    waits(lambda: is_gone(int(path.read_text())))


def is_gone(pid: int) -> bool:
    """Whether a process has ended, even if nobody has asked for its exit status yet."""
    try:
        return ") Z " in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return True


def waits(holds: Callable[[], bool]) -> None:
    while not holds():  # the time limit of the whole test is the limit
        time.sleep(0.01)


def test_no_process_and_no_pipe_is_left_over() -> None:
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(3):
        with started(ECHO) as program:
            program.step([1, True])
    assert len(os.listdir("/proc/self/fd")) == before
