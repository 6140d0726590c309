"""`python -m tests.fault_injection`: how many small faults in the product the suite finds."""

from __future__ import annotations

import json
import tempfile
import threading
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import click

from tests.fault_injection.drawing import ROOT, Fault, drawn, room_of
from tests.fault_injection.selection import Neighbourhood
from tests.fault_injection.trial import Finding, Trial, copied, tried

HERE = Path(__file__).parent


def known(root: Path) -> list[Fault]:
    """Read `known.toml`: wrong answers that were once there, as changes of today's text."""
    faults = []
    for entry in tomllib.loads((HERE / "known.toml").read_text("utf-8"))["fault"]:
        text = root.joinpath(entry["path"]).read_bytes()
        old = entry["old"].encode()
        assert text.count(old) == 1, f"{entry['path']}: {entry['old']!r} is there {text.count(old)} times"
        faults.append(Fault(entry["path"], text.index(old), entry["old"], entry["new"], "known"))
    return faults


def equivalent() -> dict[str, str]:
    """Read `equivalent.toml`: ids of faults that change nothing a user could see, and why."""
    return dict(tomllib.loads((HERE / "equivalent.toml").read_text("utf-8")))


def results(faults: list[Fault], root: Path, jobs: int, limit: int) -> Iterator[Trial]:
    """Try each fault, so many at a time, each job in its own copy of the tree."""
    near = Neighbourhood(root)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        trees: SimpleQueue[Path] = SimpleQueue()
        for job in range(jobs):
            trees.put(copied(root, Path(folder, str(job))))

        def one(fault: Fault) -> Trial:
            tree = trees.get()
            try:
                return tried(fault, tree, near.files(fault.path), limit)
            finally:
                trees.put(tree)

        yield from pool.map(one, faults)


def table(trials: list[Trial]) -> str:
    """A row for each room: how many faults were found, survived, ran out of time, change nothing."""
    heads = [finding.value for finding in Finding]
    rooms = sorted({room_of(trial.fault.path) for trial in trials})
    counts = {
        room: Counter(t.finding.value for t in trials if room_of(t.fault.path) == room)
        for room in rooms
    }
    rows = [[room, *(str(counts[room][head]) for head in heads)] for room in rooms]
    total = Counter(trial.finding.value for trial in trials)
    rows.append(["all", *(str(total[head]) for head in heads)])
    return "\n".join(
        f"{row[0]:<24}" + "".join(f"{cell:>13}" for cell in row[1:]) for row in [["room", *heads], *rows]
    )


@click.command(context_settings={"show_default": True})
@click.option("--seed", default=1, help="Seed of the random choice of faults.")
@click.option("--count", default=150, help="Number of drawn faults; the known ones come on top.")
@click.option("--jobs", default=2, help="Faults that are tried at a time.")
@click.option("--limit", default=120, metavar="SECONDS", help="CPU time for each fault's tests.")
@click.option("--only", multiple=True, metavar="ID", help="Try this fault alone; repeatable.")
@click.option("--tree", type=Path, default=ROOT, help="The checkout whose product and tests are tried.")
@click.option("--output", type=Path, help="Write the result of each fault as JSON.")
def main(
    seed: int, count: int, jobs: int, limit: int, only: tuple[str, ...], tree: Path, output: Path | None
) -> None:
    """Change one place of the product at a time, and say whether a test near it fails.

    Prints a line for each fault that no test found, then a table by room.
    """
    faults = [*known(tree), *drawn(tree, seed, count)]
    faults = [fault for fault in faults if not only or fault.id in only]
    same = {} if only else equivalent()
    tries = [fault for fault in faults if fault.id not in same]
    trials = [
        Trial(fault, fault.line((tree / fault.path).read_bytes()), Finding.EQUIVALENT, "", 0.0)
        for fault in faults
        if fault.id in same
    ]
    begun, lock = time.monotonic(), threading.Lock()
    for trial in results(tries, tree, jobs, limit):
        trials.append(trial)
        with lock:
            if trial.finding is not Finding.FOUND or only:
                click.echo(_line(trial))
        if output:
            output.write_text(json.dumps([_row(t) for t in trials], indent=1) + "\n", "utf-8")
    click.echo(table(trials))
    spent = sum(trial.seconds for trial in trials)
    click.echo(f"{len(trials)} faults, {time.monotonic() - begun:.0f} s, {spent:.0f} CPU s")


def _line(trial: Trial) -> str:
    fault = trial.fault
    place = f"{fault.path}:{trial.line}"
    return f"{fault.id} {trial.finding.value}: {place} {fault.kind}: {fault.old!r} → {fault.new!r} {trial.test}"


def _row(trial: Trial) -> dict[str, object]:
    fault = trial.fault
    return {
        "id": fault.id,
        "path": fault.path,
        "line": trial.line,
        "kind": fault.kind,
        "old": fault.old,
        "new": fault.new,
        "finding": trial.finding.value,
        "test": trial.test,
        "cpu_s": trial.seconds,
    }


if __name__ == "__main__":
    main()
