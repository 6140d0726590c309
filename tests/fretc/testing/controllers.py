"""A program that keeps three requirements, and programs that are wrong in one place each."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from types import SimpleNamespace
from typing import Self

from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.conformance.conformance_run import ConformanceRun
from fretc.testing.conformance.findings import Conformance
from fretc.testing.conformance.program import ProgramRun
from tests.requirement_sets import requirement, requirements, roles

SENTENCES = (
    "upon start the line shall within 3 ticks satisfy run",
    "whenever stop & !start the line shall immediately satisfy !run",
    "upon stop & !start the line shall for 2 ticks satisfy alarm",
)
INPUTS, OUTPUTS = ("start", "stop"), ("alarm", "run")
PROMISE = "whenever start the plant shall for 3 ticks satisfy !stop"
"""Without it the first two fight."""
ASSUMED = requirement("A1", PROMISE)
RULES: Mapping[str, FormalizedRequirement] = {each.id: each for each in requirements(*SENTENCES)}
RIGHT = """\
import sys

was_start = was_halted = False
left = 0  # ticks for which the alarm goes on
due = -1  # ticks until the line runs; -1: nothing asks for it
starts = 0
names = sys.stdin.readline().strip().split(",")
print("alarm,run", flush=True)
while line := sys.stdin.readline():
    row = dict(zip(names, line.strip().split(",")))
    start, stop = row["start"] == "true", row["stop"] == "true"
    halted = stop and not start
    if start and not was_start:
        starts += 1
        due = 2 if due < 0 else due
    run = due == 0 and not halted
    due -= due >= 0
    if halted and not was_halted:
        left = 3
    alarm = left > 0
    left -= alarm
    was_start, was_halted = start, halted
    print(f"{int(alarm)},{int(run)}", flush=True)
"""
FAULTS: Mapping[str, tuple[str, str]] = {
    "never runs": ("run = due == 0 and not halted", "run = False"),
    "always runs": ("run = due == 0 and not halted", "run = True"),
    "runs a tick late": ("due = 2", "due = 4"),
    "counts anew at a second start": ("2 if due < 0 else due", "2"),
    "runs for the first start only": ("due = 2 if due < 0", "due = 2 if starts == 1"),
    "runs for two starts only": ("due = 2 if due < 0", "due = 2 if due < 0 and starts < 3"),
    "takes a start for a level": ("if start and not was_start", "if start and left == 0"),
    "runs on while it is halted": ("due == 0 and not halted", "due == 0 or was_halted"),
    "alarm ends a tick early": ("left = 3", "left = 2"),
    "alarm is a tick late": ("alarm = left > 0", "alarm = 0 < left < 3"),
    "alarm for the first stop only": ("left = 3", "left, halted = 3 * (starts < 9), 1; starts = 9"),
    "alarm ends with the stop": ("alarm = left > 0", "alarm = left > 0 and halted"),
    "alarm ends with a start": ("alarm = left > 0", "alarm = left > 0 and not start"),
    "a second stop makes the alarm no longer": ("if halted and", "if not left and halted and"),
    "a shorter alarm after a start": ("left = 3", "left = 2 if starts else 3"),
}
"""What is replaced in `RIGHT`, and by what: each program violates one of them on some run."""


def program(fault: str | None = None) -> str:
    """Its text."""
    if fault is None:
        return RIGHT
    was, wrong = FAULTS[fault]
    assert RIGHT.count(was) == 1, fault
    return RIGHT.replace(was, wrong)


class Within(ProgramRun):
    """A run of a text in this process, in a thread of its own."""

    def __enter__(self) -> Self:
        """Start it."""
        self._given, self._told = SimpleQueue[str](), SimpleQueue[str]()
        stdin = SimpleNamespace(readline=self._given.get)
        space = {
            "sys": SimpleNamespace(stdin=stdin),
            "print": lambda line, flush: self._told.put(line),
        }
        (text,) = self._command
        code = compile(text.removeprefix("import sys\n"), "program.py", "exec")
        self._thread = Thread(target=exec, args=(code, space), daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Give it no more lines."""
        self._given.put("")
        self._thread.join()

    def _send(self, line: str) -> None:
        self._given.put(line)

    def _reads(self, seconds: float) -> bool:
        try:
            line = self._told.get(block=seconds > 0, timeout=seconds or None)
        except Empty:
            return False
        self._buffer += f"{line}\n".encode()
        return True


def seen_of(text: str, folder: Path | None = None) -> Conformance:
    """What is seen of a program, run in that folder, or else within this process."""
    kind: type[ProgramRun] = Within
    command = [text]
    if folder is not None:
        path = folder / "program.py"
        path.write_text(text)
        kind, command = ProgramRun, [sys.executable, "-ISE", str(path)]
    campaign = ConformanceRun([*RULES.values()], [ASSUMED], roles(INPUTS, OUTPUTS), 60)
    columns = campaign.oracle.inputs, campaign.oracle.outputs
    campaign.run(partial(kind, command, *columns, seconds=60), lambda words: None)
    return campaign.findings(command)
