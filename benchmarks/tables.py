"""A generated monitor over tables: the whole process, against `csv.reader` alone in the same run.

    python -m benchmarks.tables [--rows N] [--runs N]

Four propositions. CPU time, the medians of the runs, and the most memory of the process.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.figures import RUNS, Figure
from benchmarks.monitoring import requirement
from benchmarks.timing import seconds
from compiler.targets.python.monitor import text

LIMITS = {"digits": 1.0, "words, unknowns": 1.5}
"""Times `csv.reader`, for a million rows and whole columns."""
SENTENCE = "in m mode, whenever p the sw shall within 10 ticks satisfy (q | r)"
NAMES = "m,p,q,r"


def cells(rows: int) -> Iterator[list[str]]:
    """Digits; the requirement is satisfied, with a trigger at one tick of twenty."""
    choose = random.Random(1)
    for _ in range(rows):
        yield [f"{choose.random() < odds:d}" for odds in (0.5, 0.05, 0.4, 0.4)]


def digits(rows: int) -> Iterator[str]:
    yield NAMES
    yield from map(",".join, cells(rows))


def with_ticks(rows: int) -> Iterator[str]:
    yield f"tick,{NAMES}"
    for tick, row in enumerate(cells(rows)):
        yield f"{tick},{','.join(row)}"


def words(rows: int) -> Iterator[str]:
    """One value of forty is unknown."""
    yield NAMES
    for tick, row in enumerate(cells(rows)):
        row[tick % 4] = "" if tick % 10 == 0 else ("False", "True")[int(row[tick % 4])]
        yield ",".join(row)


def json_lines(rows: int) -> Iterator[str]:
    for row in cells(rows):
        pairs = ", ".join(
            f'"{name}": {value}' for name, value in zip(NAMES.split(","), row, strict=True)
        )
        yield f"{{{pairs}}}"


TABLES: dict[str, Callable[[int], Iterator[str]]] = {
    "digits": digits,
    "and a column tick": with_ticks,
    "words, unknowns": words,
    "JSON lines": json_lines,
}


def spent(command: Sequence[str], runs: int) -> float:
    """CPU seconds of one process, the median."""
    found = []
    for _ in range(runs):
        with subprocess.Popen([sys.executable, *command], stdout=subprocess.DEVNULL) as child:
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        assert child.returncode == 0, command
        found.append(usage.ru_utime + usage.ru_stime)
    return statistics.median(found)


def memory(command: Sequence[str]) -> float:
    """The most memory of the process, in MB; what it had before it was this program not counted."""
    run = [sys.executable, "-c", MEASURED, *command]
    output = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    return int(output.split()[-2]) / 1024


MEASURED = """
import runpy, sys
del sys.argv[0]
try:
    runpy.run_path(sys.argv[0], run_name="__main__")
except SystemExit:
    print(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")))
"""


def csv_alone(path: Path) -> None:
    """What the library takes to split the table."""
    with path.open(encoding="utf-8", newline="") as lines:
        for _ in csv.reader(lines):
            pass


def figures(rows: int = 10**6) -> Iterator[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        monitor, path = Path(folder, "monitor.py"), Path(folder, "table")
        monitor.write_text(text(requirement(SENTENCE)), encoding="utf-8")
        for name, limit in LIMITS.items():
            path.write_text("\n".join(TABLES[name](rows)) + "\n", encoding="utf-8")
            command = [str(monitor), str(path)]
            pairs = [(spent(command, 1), seconds(lambda: csv_alone(path), 1)) for _ in range(RUNS)]
            value = statistics.median(ours / alone for ours, alone in pairs)
            yield Figure(f"monitor over CSV: {name}", value, "x csv.reader", limit)


def main() -> None:
    """Print a table for each kind of table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, nargs="*", default=[10**5, 10**6])
    parser.add_argument("--runs", type=int, default=7)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        monitor, path = Path(folder, "monitor.py"), Path(folder, "table")
        monitor.write_text(text(requirement(SENTENCE)), encoding="utf-8")
        print(f"{'':18} {'rows':>9} {'engine':>8} {'CPU':>8} {'x csv.reader':>13}", end="")
        print(f" {'limit':>6} {'memory':>9}")
        for name, lines in TABLES.items():
            for rows in options.rows:
                path.write_text("\n".join(lines(rows)) + "\n", encoding="utf-8")
                alone = None if lines is json_lines else seconds(lambda: csv_alone(path), 7)
                for engine in ("columns", "online"):
                    command = [str(monitor), str(path), "--engine", engine]
                    taken = spent(command, options.runs)
                    ratio = f"{taken / alone:.2f}" if alone else ""
                    limited = engine == "columns" and rows >= 10**6
                    limit = LIMITS.get(name, "") if limited else ""
                    print(
                        f"{name:18} {rows:9,} {engine:>8} {taken:6.2f} s {ratio:>13} {limit:>6} "
                        f"{memory(command):6.1f} MB"
                    )


if __name__ == "__main__":
    main()
