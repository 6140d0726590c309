"""`python -m tests.fault_injection`: how many small faults in the product the suite finds."""

from __future__ import annotations

import json
import signal
import sys
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import click

from tests.fault_injection.drawing import ROOT, Fault, drawn, room_of
from tests.fault_injection.known import Misfit, equivalent, known
from tests.fault_injection.trial import Bench, Finding, Trial


@click.command(context_settings={"show_default": True})
@click.option("--seed", default=1, help="Seed of the random choice of faults.")
@click.option("--count", default=150, help="Number of drawn faults; the known ones come on top.")
@click.option("--jobs", default=2, help="Faults that are tried at a time.")
@click.option("--limit", default=90, metavar="SECONDS", help="CPU time for each fault's tests.")
@click.option("--only", multiple=True, metavar="ID", help="Try this fault alone; repeatable.")
@click.option(
    "--tree",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=ROOT,
    show_default="this checkout",
    help="A checkout, whose product and tests are tried.",
)
@click.option(
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write as JSON what became of each fault; after each, what is known so far.",
)
def main(
    seed: int,
    count: int,
    jobs: int,
    limit: int,
    only: Sequence[str],
    tree: Path,
    output: Path | None,
) -> None:
    """Change one place of the product at a time, and say whether a test near it fails.

    Prints a line for each fault that no test found, then a table by room. The checkout is not
    changed: faults are put into copies of it.
    """
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # copies are removed
    tree = tree.resolve()
    faults = [fault for fault in _faults(tree, seed, count) if not only or fault.id in only]
    without_effect = {} if only else equivalent()
    trials = [
        Trial(fault, fault.line((tree / fault.path).read_bytes()), Finding.EQUIVALENT, reason)
        for fault in faults
        if (reason := without_effect.get(fault.id))
    ]
    for trial in trials:
        click.echo(_in_words(trial))
    begun, bench = time.monotonic(), Bench(tree, jobs, limit)
    tried = [fault for fault in faults if fault.id not in without_effect]
    with closing(bench.trials(tried)) as coming:
        for trial in coming:
            trials.append(trial)
            if only or trial.finding is not Finding.FOUND:
                click.echo(_in_words(trial))
            if output:
                output.write_text(json.dumps(list(map(_row, trials)), indent=1) + "\n", "utf-8")
    for test in sorted(bench.fails_anyway):
        click.echo(f"fails without a fault, left out: {test}")
    click.echo(f"\n{table(trials)}\n{len(trials)} faults in {time.monotonic() - begun:.0f} s")


def _faults(tree: Path, seed: int, count: int) -> list[Fault]:
    """Return the known faults that fit the tree, and the drawn ones; name those that do not fit."""
    faults = []
    for fault in known(tree):
        if isinstance(fault, Misfit):
            click.echo(f"left out: {fault.path} has {fault.times} times {fault.old!r}", err=True)
        else:
            faults.append(fault)
    return faults + drawn(tree, seed, count)


def table(trials: Sequence[Trial]) -> str:
    """Return a row for each room, with how many of its faults came to what."""
    rooms = sorted({room_of(trial.fault.path) for trial in trials})
    counts = {room: Counter[Finding]() for room in [*rooms, "all"]}
    for trial in trials:
        for room in (room_of(trial.fault.path), "all"):
            counts[room][trial.finding] += 1
    rows = [
        ["", *(finding.value for finding in Finding)],
        *([room, *(str(of[finding]) for finding in Finding)] for room, of in counts.items()),
    ]
    return "\n".join(f"{row[0]:<24}" + "".join(f"{cell:>13}" for cell in row[1:]) for row in rows)


def _in_words(trial: Trial) -> str:
    fault = trial.fault
    change = f"{fault.old!r} -> {fault.new!r}"
    text = f"{fault.id} {trial.finding.value}: {fault.path}:{trial.line}: {fault.kind}: {change}"
    return f"{text} ({trial.why})" if trial.why else text


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
        "why": trial.why,
    }


if __name__ == "__main__":
    main()
