"""Monitors in C, Rust and Java against Copilot's C and hand-written C: time of a tick, state, code.

    python -m benchmarks.compiled_monitors [--rounds N]

Programs of one task run in turn, round after round; a figure is the median of its rounds, in CPU
time. Needs gcc; clang, rustc and a JDK are used where they are installed.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.compiled_monitors.program import Program
from benchmarks.compiled_monitors.requirement_files import KINDS, Task, many, single
from benchmarks.compiled_monitors.variants import variants
from benchmarks.figures import RUNS, Figure
from benchmarks.monitoring import table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=15, help="of each program, in turn")
    rounds = parser.parse_args().rounds
    tasks = [*map(single, KINDS), many(20), many(1000), single("W2", 10), single("W2", 100_000)]
    for task in tasks:
        _print(task, *measured(task, rounds))


def figures() -> Iterator[Figure]:
    """One requirement, and many in a file, compiled by gcc."""
    for task in (*map(single, KINDS), many(20), many(1000)):
        _, times, _ = measured(task, RUNS)
        limit = 1.15 if len(task.demands) == 1 else 1.3
        value = times["fretc C, gcc"] / times["by hand, gcc"]
        yield Figure(f"monitor in C, {task.name}", value, "x by hand", limit)


def measured(
    task: Task, rounds: int
) -> tuple[dict[str, Program], dict[str, float], dict[str, str]]:
    """The programs of a task, nanoseconds a tick of each, and what each has printed at its end."""
    with TemporaryDirectory() as name:
        rows = Path(name) / "rows"
        rows.write_bytes(task.rows.tobytes())
        built = dict[str, Program]()
        for variant in variants():
            folder = Path(name) / str(len(built))
            folder.mkdir(exist_ok=True)
            program = variant.build(task, folder)
            if program is not None:
                built[variant.name] = program
        times: dict[str, list[float]] = {each: [] for each in built}
        ends = dict[str, str]()
        for _ in range(rounds):
            for each, program in built.items():
                shape = (task.rows.shape[1], task.rows.shape[0], 2)
                *found, ends[each] = _run(program.path, rows, shape)
                times[each].append(float(found[-1]))
    sums = {end.split()[0] for end in ends.values()}
    assert len(sums) == 1, f"they disagree: {ends}"
    return built, {each: statistics.median(found) for each, found in times.items()}, ends


def _run(program: Path, rows: Path, shape: Sequence[int]) -> list[str]:
    """The lines that it prints."""
    command = [str(program), str(rows), *map(str, shape)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.splitlines()


def _print(
    task: Task,
    built: dict[str, Program],
    times: dict[str, float],
    ends: dict[str, str],
) -> None:
    best = {cc: times[f"by hand, {cc}"] for cc in ("gcc", "clang") if f"by hand, {cc}" in times}
    rows = []
    for name, program in built.items():
        peer = best.get(name.rpartition(", ")[2], min(best.values()))
        state = ends[name].split()[1]
        each = times[name] / len(task.demands)
        ratio = f"{times[name] / peer:.2f}"
        rows.append(
            (name, f"{times[name]:.2f}", f"{each:.2f}", ratio, state, program.code or "inlined")
        )
    head = ("", "ns a tick", "a requirement", "x by hand", "state", "code")
    table(task.name, head, rows)


if __name__ == "__main__":
    main()
