"""Many logs, in some processes and on Dask; and a table of ten thousand runs.

    python -m benchmarks.fleet LOG [--count 100] [--jobs 2] [--requirements FOLDER] [--dask]

Wall time, since processes share the work; the log is linked under as many names. No test
asserts it.
"""

from __future__ import annotations

import argparse
import os
import secrets
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from compiler.files.text_files import sha256
from compiler.project.folder import load
from compiler.project.paths import beside, requirement_files
from fretc.audit import fleet
from fretc.audit.journal import Journal
from fretc.audit.many_logs import Audit, Engine, audit_logs, locally
from fretc.audit.outputs.summary import summarized
from fretc.audit.outputs.table import parquet, read
from fretc.audit.plan import Plan, planned
from fretish.diagnostics.diagnostic import Diagnostic

RUNS = 10_000


def plan(requirements: str) -> Plan:
    files = requirement_files(requirements)
    assert not isinstance(files, Diagnostic), files.message
    made = planned(load(files, beside(requirements, "bindings.toml")))
    assert isinstance(made, Plan), made
    return made


def linked(log: str, count: int, folder: Path) -> list[str]:
    """The log under as many names."""
    names = [str(folder / f"run{number:05}.mcap") for number in range(count)]
    for name in names:
        os.link(os.path.realpath(log), name)
    return names


def timed(judged: Plan, logs: Sequence[str], engine: Engine, folder: Path) -> tuple[float, Audit]:
    """Wall time of an audit, with its journal."""
    journal = Journal(folder / "evidence.json", judged, secrets.token_bytes(32))
    start = time.perf_counter()
    audit = audit_logs(judged, logs, engine, tell=lambda log, found: _kept(journal, log, found))
    journal.remove()
    taken = time.perf_counter() - start
    assert isinstance(audit, Audit), audit.message
    assert audit.read == len(logs)
    return taken, audit


def _kept(journal: Journal, *found: object) -> None:
    assert journal.keep(*found) is True  # type: ignore[arg-type]


def engines(jobs: int, *, dask: bool) -> dict[str, Engine]:
    found = {f"{jobs} process{'es' if jobs > 1 else ''}": locally(jobs)}
    if dask:
        there = fleet.engine("dask", jobs)
        assert not isinstance(there, Diagnostic), there.message
        found[f"Dask, {jobs} workers"] = there
    return found


def table(audit: Audit, path: Path) -> None:
    """Write, and summarize, three requirements in ten thousand runs."""
    (record, *_) = audit.results
    results = [
        {
            **record,
            "run": f"run{run}.mcap",
            "requirement": f"R{number}",
            "hashes": {**record["hashes"], "log": sha256(str(run))},
        }
        for run in range(RUNS)
        for number in (1, 2, 3)
    ]
    path.write_bytes(parquet(results, "benchmark"))
    start = time.perf_counter()
    rows = read([str(path)])
    assert not isinstance(rows, Diagnostic), rows.message
    summary = summarized(rows)
    taken = time.perf_counter() - start
    assert summary.whole["runs"] == RUNS
    size = path.stat().st_size / 1e6
    print(f"table of {RUNS} runs x 3 requirements: {size:.1f} MB, summarized in {taken:.2f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--requirements", default="requirements")
    parser.add_argument("--dask", action="store_true", help="also on a cluster of this machine")
    options = parser.parse_args()
    judged = plan(options.requirements)
    size = Path(options.log).stat().st_size / 1e6
    print(f"{options.count} logs of {size:.1f} MB")
    beside_it = Path(os.path.realpath(options.log)).parent  # a link cannot lead to another disk
    with tempfile.TemporaryDirectory(dir=beside_it) as folder:
        logs = linked(options.log, options.count, Path(folder))
        for name, engine in engines(options.jobs, dask=options.dask).items():
            taken, audit = timed(judged, logs, engine, Path(folder))
            print(f"  {name:18} {taken:6.1f} s, {len(logs) / taken:6.1f} logs per second")
        table(audit, Path(folder) / "runs.parquet")


if __name__ == "__main__":
    main()
