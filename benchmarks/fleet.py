"""Many logs, in some processes and on Dask; and a table of ten thousand runs.

    python -m benchmarks.fleet LOG [--count 100] [--jobs 2] [--requirements FOLDER] [--dask]

Wall time, since processes share the work; the log is linked under as many names. No test
asserts it.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.logs import Options, record
from compiler.files.records import replace
from compiler.files.text_files import sha256
from compiler.project.folder import load
from compiler.project.paths import requirement_files, sibling_path
from fretc.audit import dask_executor
from fretc.audit.evidence.schema import Result
from fretc.audit.into_store import StoredAudit, StoreWriter
from fretc.audit.many_logs import Engine, audit_log, local_executor
from fretc.audit.outputs.summary import summarize
from fretc.audit.outputs.table import parquet, read, row_of
from fretc.audit.plan import Plan, planned
from fretish.diagnostics.diagnostic import Diagnostic

RUNS = 10_000


def plan(requirements: str) -> Plan:
    files = requirement_files(requirements)
    assert not isinstance(files, Diagnostic), files.message
    made = planned(load(files, sibling_path(requirements, "bindings.toml")))
    assert isinstance(made, Plan), made
    return made


def linked(log: str, count: int, folder: Path) -> list[str]:
    """The log under as many names."""
    names = [str(folder / f"run{number:05}.mcap") for number in range(count)]
    for name in names:
        os.link(os.path.realpath(log), name)
    return names


def timed(judged: Plan, logs: Sequence[str], engine: Engine, folder: Path) -> tuple[float, int]:
    """Wall time of an audit into a store, and how many logs were read for it."""
    start = time.perf_counter()
    with StoreWriter(folder / "evidence", judged, logs, b"benchmark", rehash=False) as session:
        audit = session.run(engine, lambda log: None)
    taken = time.perf_counter() - start
    assert isinstance(audit, StoredAudit), audit.message
    assert audit.read == len(logs)
    return taken, len(session.new)


def listed(logs: Sequence[str]) -> float:
    """Wall time of asking the file system for all logs, as `ls -l` does."""
    start = time.perf_counter()
    for log in logs:
        os.stat(log)
    return time.perf_counter() - start


def engines(jobs: int, *, dask: bool) -> dict[str, Engine]:
    found = {f"{jobs} process{'es' if jobs > 1 else ''}": local_executor(jobs)}
    if dask:
        there = dask_executor.engine("dask", jobs)
        assert not isinstance(there, Diagnostic), there.message
        found[f"Dask, {jobs} workers"] = there
    return found


def table(results: Sequence[Result], path: Path) -> None:
    """Write, and summarize, three requirements in ten thousand runs."""
    (record, *_) = results
    many = [
        replace(
            record,
            run=f"run{run}.mcap",
            requirement=f"R{number}",
            fingerprints=replace(record.fingerprints, log=sha256(str(run))),
        )
        for run in range(RUNS)
        for number in (1, 2, 3)
    ]
    path.write_bytes(parquet(row_of(one, "benchmark") for one in many))
    start = time.perf_counter()
    known = read([str(path)])
    assert not isinstance(known, Diagnostic), known.message
    summary = summarize(known)
    taken = time.perf_counter() - start
    assert summary.whole["runs"] == RUNS
    size = path.stat().st_size / 1e6
    print(f"table of {RUNS} runs x 3 requirements: {size:.1f} MB, summarized in {taken:.2f} s")


def figures(count: int = 60) -> Iterator[Figure]:
    """A thousand ten-minute logs, from fewer: CPU time, shared by all cores."""
    judged = plan(str(Path(__file__).parent / "job/r.fret"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record(folder / "log.mcap", Options())
        logs = linked(str(folder / "log.mcap"), count, folder)
        cores, before = os.cpu_count() or 1, _cpu()
        timed(judged, logs, local_executor(cores), folder / "store")
        value = 1000 * (_cpu() - before) / count / cores
        what = f"audit of 1 000 ten-minute logs, from {count}"
        yield Figure(what, value, f"s of CPU on each of {cores} cores", 30)


def _cpu() -> float:
    """Seconds of this process and of its children that have ended."""
    return sum(os.times()[:4])


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
            place = Path(folder) / name.replace(" ", "-")
            taken, _ = timed(judged, logs, engine, place)
            print(f"  {name:18} {taken:6.1f} s, {len(logs) / taken:6.1f} logs per second")
            again, new = timed(judged, logs, engine, place)
            floor = listed(logs)
            print(f"  {'again, unchanged':18} {again:6.2f} s, {new} read; listing {floor:.3f} s")
        table(audit_log(judged, logs[0]).results, Path(folder) / "runs.parquet")


if __name__ == "__main__":
    main()
