"""How long a command takes to answer, against an empty Python and one that imports NumPy.

CPU time of whole processes, the command and its two peers in turn. The log is of one second, cut
out of `traces/`. Modules are compiled beforehand, as after an installation.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from benchmarks.figures import RUNS, Figure
from benchmarks.small_logs import cut

FRETC = str(Path(sys.executable).parent / "fretc")
ROOT = Path(__file__).parent.parent
R1 = "requirements/r1.fret"
EMPTY = [sys.executable, "-c", "pass"]
NUMPY = [sys.executable, "-c", "import numpy"]
LIMITS = {
    "fretc r1.fret --emit monitor": 1.0,
    "fretc check, 15 requirements": 1.5,
    "fretc audit, 1 s": 2.0,
    "fretc report": 2.5,
}
"""What a command may take, as a multiple of NumPy's import."""


def commands(folder: Path) -> Mapping[str, Sequence[str]]:
    """The commands, and files for them in a folder."""
    (log,) = cut(ROOT / "traces/mission-seed15.mcap", 1, folder)
    evidence, rows = str(folder / "evidence.json"), folder / "rows.csv"
    rows.write_text("too_close,stopped\n" + "false,true\n" * 10)
    seconds([FRETC, R1, "--emit", "monitor", "-o", str(folder)])
    monitor = [sys.executable, str(folder / "r1_monitor.py")]
    return {
        "import fretc": [sys.executable, "-c", "import fretc"],
        "fretc --version": [FRETC, "--version"],
        "fretc --help": [FRETC, "--help"],
        "fretc r1.fret": [FRETC, R1],
        "fretc r1.fret --emit monitor": [FRETC, R1, "--emit", "monitor", "-o", "-"],
        "python r1_monitor.py --help": [*monitor, "--help"],
        "python r1_monitor.py, 10 rows": [*monitor, str(rows)],
        "fretc check": [FRETC, "check"],
        "fretc check, 15 requirements": [FRETC, "check", "--requirements", "requirements/mission"],
        "fretc audit, 1 s": [FRETC, "audit", str(log), "--requirements", R1, "-o", evidence],
        "fretc report": [
            FRETC, "report", "--requirements", R1, "--evidence", evidence, "-o", str(folder / "r"),
        ],
    }  # fmt: skip


def seconds(command: Sequence[str]) -> float:
    """CPU time of one process; a status that says what was shown is none of its business."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=False)
    assert done.returncode in (0, 1, 3), done.stderr
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ratios(command: Sequence[str], runs: int) -> list[tuple[float, float, float]]:
    """Seconds of the command, an empty Python and NumPy's import, in turn."""
    seconds(command)
    return [(seconds(command), seconds(EMPTY), seconds(NUMPY)) for _ in range(runs)]


def figures() -> Iterator[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        there = commands(Path(folder))
        for name, limit in LIMITS.items():
            times = ratios(there[name], RUNS)
            value = statistics.median(ours / numpy for ours, _, numpy in times)
            yield Figure(name, value, "x importing NumPy", limit)


def main() -> None:
    """Print a table: least, median, and ratios of the medians pair by pair."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    runs = parser.parse_args().runs
    print(f"{'command':32} {'least':>8} {'median':>8} {'x empty Python':>16} {'x NumPy':>10}")
    with tempfile.TemporaryDirectory() as folder:
        for name, command in commands(Path(folder)).items():
            times = ratios(command, runs)
            ours = [each[0] for each in times]
            empty, numpy = (statistics.median(t[0] / t[i] for t in times) for i in (1, 2))
            least, median = min(ours), statistics.median(ours)
            print(f"{name:32} {least:7.3f}s {median:7.3f}s {empty:16.1f} {numpy:10.2f}")


if __name__ == "__main__":
    main()
