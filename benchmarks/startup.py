"""How long the command takes to answer, against an empty Python in the same run."""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

FRETC = str(Path(sys.executable).parent / "fretc")
ROOT = Path(__file__).parent.parent
COMMANDS: dict[str, Sequence[str]] = {
    "fretc --version": [FRETC, "--version"],
    "import fretc": [sys.executable, "-c", "import fretc"],
    "fretc requirements/r1.fret": [FRETC, "requirements/r1.fret"],
    "fretc requirements/r1.fret --emit monitor -o -": [
        FRETC, "requirements/r1.fret", "--emit", "monitor", "-o", "-",
    ],
}  # fmt: skip
EMPTY = [sys.executable, "-c", "pass"]


def seconds(command: Sequence[str]) -> float:
    """Wall time of one whole process."""
    start = time.perf_counter()
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return time.perf_counter() - start


def main() -> None:
    """Print a table: median, largest, and the ratio to the empty Python, pair by pair."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    runs = parser.parse_args().runs
    print(f"{'command':50} {'median':>8} {'largest':>8} {'ratio to an empty Python':>26}")
    for name, command in COMMANDS.items():
        seconds(command), seconds(EMPTY)
        pairs = [(seconds(command), seconds(EMPTY)) for _ in range(runs)]
        ours = [pair[0] for pair in pairs]
        ratio = statistics.median(a / b for a, b in pairs)
        print(f"{name:50} {statistics.median(ours):7.3f}s {max(ours):7.3f}s {ratio:26.1f}")


if __name__ == "__main__":
    main()
