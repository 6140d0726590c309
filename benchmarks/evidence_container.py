"""A store of many runs: the time of each step, the memory and the size.

    python -m benchmarks.evidence_container EVIDENCE.json [--sizes 2000x15,1000x100]

Results are made from one real result (`fretc audit LOG -o EVIDENCE.json`), with other times,
triggers and latencies in each run. Each step is done in a process of its own.
"""

from __future__ import annotations

import argparse
import random
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from compiler.files.records import UNSET, decoded, plain, replace
from compiler.files.text_files import sha256
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.reader import read as read_file
from fretc.audit.evidence.schema import EvidenceDocument, Result
from fretc.audit.outputs.summary import run_query, summarize
from fretc.audit.outputs.table import read as read_tables
from fretc.audit.store.anywhere import source
from fretc.audit.store.container import FILE, check_record, packed, record_of
from fretc.audit.store.container import opened as opened_file
from fretc.audit.store.reader import Store
from fretc.audit.store.writer import StoreFile, complete, publish
from fretish.diagnostics.diagnostic import Diagnostic

CHANGED = 12
"""Runs of a night that have changed."""
SHOWN = 200
"""Results that a report shows in full."""
VIOLATED = 0.03
QUERY = (
    "SELECT requirement, count(*), sum(violations), max(latency_max_s) FROM results "
    "WHERE verdict <> 'satisfied' GROUP BY requirement ORDER BY requirement"
)


# Results ------------------------------------------------------------------------------------------


def run_of(original: Result, number: int, requirements: int, seed: int = 0) -> list[Result]:
    """The results of one run; equal numbers and seeds give equal results."""
    choose = random.Random(number * 7919 + seed)
    shift = choose.randrange(10**15)
    log = sha256(f"{number} {seed}")
    health = replace(original.health, size=choose.randrange(10**6, 10**9))
    results = []
    for id in range(requirements):
        triggers = [m for m in original.triggers if choose.random() < 0.4]
        ticks = {moment.tick for moment in triggers}
        late = [round(choose.uniform(0, 0.9), 3) for _ in triggers]
        violations = _violations(choose, original) if choose.random() < VIOLATED else []
        record = plain(
            replace(
                original,
                run=f"runs/{number:05}.mcap",
                requirement=f"R{id + 1}",
                verdict="violated" if violations else "satisfied",
                triggers=tuple(triggers),
                answers=tuple(a for a in original.answers if a.trigger in ticks),
                latencies=tuple(late),
                exercised=len(triggers),
                latency_max_s=max(late, default=None),
                fingerprints=replace(original.fingerprints, log=log),
                health=health,
                course=UNSET if id else original.course,
            )
        )
        results.append(decoded(_shifted({**record, "violations": violations}, shift), Result))
    return results


def _shifted(value: Any, shift: int, key: str = "") -> Any:
    """All times of the log, later by some nanoseconds."""
    match value:
        case dict():
            return {key: _shifted(each, shift, key) for key, each in value.items()}
        case list() | tuple():
            return [_shifted(each, shift, key) for each in value]
        case int() if key in ("ns", "start_ns", "end_ns", "first_ns", "last_ns", "times_ns"):
            return value + shift
    return value


def _violations(choose: random.Random, original: Result) -> list[dict[str, Any]]:
    """Some violations, each with samples around it."""
    start = original.start_ns or 0
    found = []
    for first in sorted(choose.sample(range(original.ticks - 10), 5)):
        begin = start + first * 10**8
        times = [begin + at * 40_000_000 for at in range(50)]
        values = [round(choose.uniform(0, 0.4), 4) for _ in times]
        found.append(
            {
                "first_tick": first,
                "last_tick": first + 3,
                "start_ns": begin,
                "end_ns": begin + 3 * 10**8,
                "start_s": first / 10,
                "end_s": (first + 3) / 10,
                "trigger": None,
                "deadline": None,
                "missing": "stopped",
                "values": {"vx": values[0]},
                "window": {
                    "start_ns": times[0],
                    "end_ns": times[-1],
                    "samples": {"vx": {"times_ns": times, "values": values}},
                },
            }
        )
    return found


# Steps --------------------------------------------------------------------------------------------


def write(path: Path, head: EvidenceDocument, runs: Iterator[list[Result]]) -> None:
    file = StoreFile(path / "unfinished-1.sqlite")
    for place, run in enumerate(runs):
        file.put(*packed(place, run))
    complete(file.path, head, file.close())
    publish(file.path)


def change(path: Path, fresh: dict[int, list[Result]]) -> None:
    """As an audit does: the records of other runs are copied."""
    before, file = store(path), StoreFile(path / "unfinished-1.sqlite")
    with opened_file(before.path) as connection:
        file.connection.execute("BEGIN")
        for row in before.rows:
            if row.place not in fresh:
                record = record_of(connection, row.place)
                check_record(row, record)
                file.put(row, record)
        file.connection.execute("COMMIT")
    for place, run in fresh.items():
        file.put(*packed(place, run))
    complete(file.path, before.document, file.close())
    publish(file.path)


def store(path: Path) -> Store:
    found = source(str(path))
    assert isinstance(found, Store), found
    return found


def summaries(path: Path) -> None:
    deque(store(path).summaries(), maxlen=0)


def facts(path: Path) -> None:
    deque(store(path).runs(), maxlen=0)


def details(path: Path) -> None:
    found = store(path)
    count = sum(row.results for row in found.rows)
    deque(found.details(range(0, count, max(1, count // SHOWN))), maxlen=0)


def latencies(path: Path) -> None:
    deque(store(path).latencies(["R1"]), maxlen=0)


def full(path: Path) -> None:
    deque(store(path).results(), maxlen=0)


def query(path: Path) -> None:
    tables = read_tables([str(path)], QUERY)
    assert not isinstance(tables, Diagnostic)
    assert not isinstance(run_query(tables, QUERY), Diagnostic)


def summary(path: Path) -> None:
    tables = read_tables([str(path)])
    assert not isinstance(tables, Diagnostic)
    summarize(tables)


# Each step in a process of its own ----------------------------------------------------------------

Step = Callable[..., object]
STEPS: dict[str, Step] = {
    "open": store,
    "summaries": summaries,
    "facts of runs": facts,
    f"{SHOWN} results in full": details,
    "latencies of R1": latencies,
    "all of all results": full,
    "query": query,
    "summary": summary,
}


def _timed(step: Step, *values: object) -> tuple[float, float]:
    """Seconds of CPU, and the most MB of memory."""
    start = time.process_time()
    step(*values)
    status = Path("/proc/self/status").read_text(encoding="ascii")
    most = int(status.partition("VmHWM:")[2].split()[0]) * 1024 / 1e6
    return time.process_time() - start, most


def _written(path: Path, evidence: str, runs: int, requirements: int) -> tuple[float, float]:
    head, original = _original(evidence)
    path.mkdir(exist_ok=True)
    took = 0.0

    def made() -> Iterator[list[Result]]:
        nonlocal took  # making the results is not writing them
        for number in range(runs):
            start = time.process_time()
            run = run_of(original, number, requirements)
            took += time.process_time() - start
            yield run

    total, most = _timed(write, path, head, made())
    return total - took, most


def _changed(path: Path, evidence: str, runs: int, requirements: int) -> tuple[float, float]:
    _, original = _original(evidence)
    numbers = [round(n * runs / CHANGED) for n in range(CHANGED)]
    fresh = {number: run_of(original, number, requirements, seed=1) for number in numbers}
    return _timed(change, path, fresh)


def _original(path: str) -> tuple[EvidenceDocument, Result]:
    found = read_file(path)
    assert isinstance(found, EvidenceFile), found
    return replace(found.document, results=()), found.document.results[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("evidence", help="a JSON file with at least one result")
    parser.add_argument("--sizes", default="2000x15,1000x100", help="runs x requirements")
    parser.add_argument("--folder", help="for the files, default: a temporary one")
    options = parser.parse_args()
    alone = get_context("spawn")

    def row(name: str, step: Callable[..., tuple[float, float]], *values: object) -> None:
        with alone.Pool(1) as one:
            took, most = one.apply(step, values)
        print(f"  {name:24} {took:7.2f} s {most:5.0f} MB", flush=True)

    for size in options.sizes.split(","):
        runs, requirements = map(int, size.split("x"))
        with tempfile.TemporaryDirectory(dir=options.folder) as name:
            path, shape = Path(name, "store"), (options.evidence, runs, requirements)
            print(f"{runs} runs x {requirements} requirements: seconds of CPU, most memory")
            row("write", _written, path, *shape)
            for title, step in STEPS.items():
                row(title, _timed, step, path)
            row(f"{CHANGED} changed runs", _changed, path, *shape)
            print(f"  {'size':24} {(path / FILE).stat().st_size / 1e6:7.1f} MB")


if __name__ == "__main__":
    main()
