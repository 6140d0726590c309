"""CPU time of each layer of `fretc verify` for the paper's requirement, against Dafny's own run.

Each layer is a command of its own, with what it starts; so its start is in each row. Dafny, the
slowest of the provers of others, verifies the file of the same requirement.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.figures import RUNS, Figure
from compiler.logic.claims import Layer
from compiler.project.folder import load
from compiler.targets import dafny
from fretc.verification.engines.dafny import answer

REQUIREMENT = Path(__file__).parent.parent / "requirements/r1.fret"
LIMIT = 8.0
"""Seconds of CPU for all layers in one command."""


def cpu(run: Callable[[], object]) -> float:
    """Seconds of CPU of all programs that are started meanwhile."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def fretc(*arguments: str) -> float:
    """Of one command."""
    command = [str(Path(sys.executable).with_name("fretc")), *arguments]
    return cpu(lambda: subprocess.run(command, capture_output=True, check=False))


def figures() -> Iterator[Figure]:
    mission = str(REQUIREMENT.parent / "mission")
    for what, path, limit in (("R1", str(REQUIREMENT), 3.0), ("the mission", mission, 6.0)):
        with tempfile.TemporaryDirectory() as folder:
            command = ("verify", path, "--output", f"{folder}/proofs.json")
            value = statistics.median(fretc(*command) for _ in range(RUNS))
        yield Figure(f"verify of {what}, all layers", value, "s of CPU", limit)


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        verify = ("verify", str(REQUIREMENT), "--output", f"{folder}/proofs.json")
        rows: dict[str, float] = {
            "start": fretc("--version"),
            **{layer: fretc(*verify, "--layer", layer) for layer in Layer},
            "all layers": fretc(*verify),
        }
    project = load([str(REQUIREMENT)], None)
    text = dafny.text(project.formalized[0], project.declarations)
    peer = cpu(lambda: print(f"Dafny: {answer(text)[0].detail}"))
    for what, seconds in rows.items():
        print(f"{what:12} {seconds:6.2f} s of CPU, {seconds / peer:5.2f} of Dafny's")
    print(f"all layers take {rows['all layers'] / LIMIT:.2f} of the limit")


if __name__ == "__main__":
    main()
