"""A store of many runs: the time of each step, the memory and the size.

    python -m benchmarks.evidence_container EVIDENCE.json [--sizes 2000x15,1000x100]

Results are made from one real result (`fretc audit LOG -o EVIDENCE.json`), with other times,
triggers and latencies in each run. Each step is done in a process of its own.
"""

from __future__ import annotations

import argparse
import os
import random
import tempfile
import time
from collections import deque
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.fleet import plan
from compiler.files.records import UNSET, decoded, plain, replace
from compiler.files.text_files import sha256, stamp
from compiler.files.user_key import user_key
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.reader import read as read_file
from fretc.audit.evidence.schema import Result
from fretc.audit.into_store import StoredAudit, StoreWriter
from fretc.audit.many_logs import LogAudits, LogResult
from fretc.audit.outputs.summary import run_query, summarize
from fretc.audit.outputs.table import read as read_tables
from fretc.audit.plan import Plan
from fretc.audit.store.anywhere import source
from fretc.audit.store.container import FILE
from fretc.audit.store.reader import Store
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


class Night:
    """An audit by the product's own writer; only the verdicts of the logs are made up."""

    def __init__(self, evidence: str, runs: int, requirements: int, seed: int) -> None:
        found = read_file(evidence)
        assert isinstance(found, EvidenceFile), found
        self.original = found.document.results[0]
        self.runs, self.requirements, self.seed = runs, requirements, seed
        self.making = 0.0
        """Seconds of CPU that results took to make, which is not writing them."""

    def audit(self, path: Path, plan: Plan) -> None:
        key = user_key()
        assert isinstance(key, bytes), key
        logs = [str(log) for log in logs_of(path, self.runs)]
        with StoreWriter(path, plan, logs, key, rehash=False) as session:
            done = session.run(self._engine, lambda log: None)
        assert isinstance(done, StoredAudit), done.message

    def _engine(self, plan: Plan, logs: Sequence[str]) -> LogAudits:
        for log in logs:
            start = time.process_time()
            run = run_of(self.original, int(Path(log).stem), self.requirements, self.seed)
            self.making += time.process_time() - start
            yield log, LogResult(tuple(run), (), read=True, stamp=stamp(log))


def logs_of(path: Path, runs: int) -> list[Path]:
    """The logs of a store: small files, which are never read."""
    return [path.with_name("logs") / f"{number:05}.mcap" for number in range(runs)]


def written(logs: Sequence[Path], text: str) -> None:
    """Write the logs, and wait until their times identify them."""
    for log in logs:
        log.parent.mkdir(exist_ok=True)
        log.write_text(text)
    time.sleep(2.1)


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


def _night(path: Path, requirements: str, *shape: Any) -> tuple[float, float]:
    night, audit_plan = Night(*shape), plan(requirements)
    total, most = _timed(night.audit, path, audit_plan)
    return total - night.making, most


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("evidence", help="a JSON file with at least one result")
    parser.add_argument("--sizes", default="2000x15,1000x100", help="runs x requirements")
    parser.add_argument("--folder", help="for the files, default: a temporary one")
    parser.add_argument("--requirements", default="requirements/r1.fret", help="of the result")
    options = parser.parse_args()
    alone = get_context("spawn")

    def row(name: str, step: Callable[..., tuple[float, float]], *values: object) -> None:
        with alone.Pool(1) as one:
            took, most = one.apply(step, values)
        print(f"  {name:24} {took:7.2f} s {most:5.0f} MB", flush=True)

    for size in options.sizes.split(","):
        runs, requirements = map(int, size.split("x"))
        with tempfile.TemporaryDirectory(dir=options.folder) as name:
            os.environ["XDG_STATE_HOME"] = name  # where the user's key is
            path = Path(name, "store")
            night = path, options.requirements, options.evidence, runs, requirements
            logs = logs_of(path, runs)
            written(logs, "first")
            print(f"{runs} runs x {requirements} requirements: seconds of CPU, most memory")
            row("write", _night, *night, 0)
            for title, step in STEPS.items():
                row(title, _timed, step, path)
            row("nothing has changed", _night, *night, 0)
            written([logs[round(n * runs / CHANGED)] for n in range(CHANGED)], "second")
            row(f"{CHANGED} runs have changed", _night, *night, 1)
            print(f"  {'size':24} {(path / FILE).stat().st_size / 1e6:7.1f} MB")


if __name__ == "__main__":
    main()
