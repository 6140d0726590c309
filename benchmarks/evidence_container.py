"""Parquet tables against one SQLite file as the container of the evidence of many runs.

    python -m benchmarks.evidence_container EVIDENCE.json [--sizes 2000x15,1000x100]

Results are made from one real result (`fretc audit LOG -o EVIDENCE.json`), with other times,
triggers and latencies in each run. Each step is done in a process of its own; the ratio is that of
both containers in this run of the benchmark. The SQLite file has a row for each run, with its
results as JSON (zstd), and a row for each result, with the columns that are counted.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import sqlite3
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import msgspec
import zstandard

from compiler.files.build_id import __version__
from compiler.files.records import UNSET, decoded, plain, replace
from compiler.files.text_files import sha256
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.reader import read as read_file
from fretc.audit.evidence.result_summaries import ResultSummary, brief
from fretc.audit.evidence.schema import Document, Hashes, Result
from fretc.audit.outputs.summary import run_query, summarize
from fretc.audit.outputs.table import read as read_tables
from fretc.audit.store.anywhere import source
from fretc.audit.store.manifest import SCHEMA, Manifest, Part
from fretc.audit.store.parts import parts
from fretc.audit.store.reader import Store, opened
from fretc.audit.store.tables import to_tables
from fretc.audit.store.writer import write_manifest, write_part
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


# Parquet ------------------------------------------------------------------------------------------


def _part(folder: Path, results: Sequence[Result]) -> Part:
    part = write_part(folder, to_tables(results, __version__))
    assert isinstance(part, Part), part
    return part


def parquet_write(path: Path, head: Document, runs: Iterator[list[Result]], count: int) -> None:
    names = [f"runs/{number:05}.mcap" for number in range(count)]
    made = tuple(
        _part(path, [each for run in islice(runs, len(some)) for each in run])
        for some in parts(names)
    )
    fields = head.fretc, head.bindings, head.requirements, None, made
    assert isinstance(write_manifest(path, Manifest(SCHEMA, *fields)), str)


def parquet_change(path: Path, fresh: dict[int, list[Result]]) -> None:
    """Write the parts of some runs again."""
    store = opened(str(path))
    assert isinstance(store, Store)
    parts_now, run, index = [], 0, 0
    for part in store.manifest.parts:
        own = [number for number in fresh if run <= number < run + part.runs]
        if own:
            results = dict(store.details(range(index, index + part.results)))
            each = part.results // part.runs
            for number in own:
                start = index + (number - run) * each
                results |= dict(enumerate(fresh[number], start))
            part_now = _part(path, [results[at] for at in sorted(results)])
        parts_now.append(part_now if own else part)
        run, index = run + part.runs, index + part.results
    made = replace(store.manifest, parts=tuple(parts_now))
    assert isinstance(write_manifest(path, made), str)


def parquet_open(path: Path) -> Store:
    """As every command does, with the comparison of verdicts."""
    store = source(str(path))
    assert isinstance(store, Store)
    return store


def parquet_briefs(path: Path) -> int:
    return sum(1 for _ in parquet_open(path).briefs())


def parquet_details(path: Path, count: int) -> int:
    store = parquet_open(path)
    return sum(1 for _ in store.details(range(0, count, max(1, count // SHOWN))))


def parquet_latencies(path: Path) -> int:
    return sum(len(late) for _, late in parquet_open(path).latencies(["R1"]))


def parquet_full(path: Path) -> None:
    parquet_open(path).check_tables()


def parquet_query(path: Path) -> None:
    tables = read_tables([str(path)])
    assert not isinstance(tables, Diagnostic)
    assert not isinstance(run_query(tables, QUERY), Diagnostic)


def parquet_summary(path: Path) -> None:
    tables = read_tables([str(path)])
    assert not isinstance(tables, Diagnostic)
    summarize(tables)


# SQLite -------------------------------------------------------------------------------------------

_HASHES = Hashes.__struct_fields__
_COLUMNS = tuple(
    name for name in ResultSummary.__dataclass_fields__ if name not in ("fingerprints", "trials")
)
_ALL = (*_COLUMNS, "trials", *(f"{name}_sha256" for name in _HASHES))
_SCHEMA = f"""
CREATE TABLE head (record TEXT, sha256 TEXT);
CREATE TABLE runs (id INTEGER PRIMARY KEY, run TEXT, sha256 TEXT, size INTEGER, record BLOB);
CREATE TABLE results (run_id INTEGER, {", ".join(_ALL)});
"""
_RECORDS = msgspec.json.Decoder(list[Result])
_ENCODER = msgspec.json.Encoder()


class _Late(msgspec.Struct):
    requirement: str
    latencies_s: tuple[float, ...]


def _values(summary: ResultSummary) -> tuple[Any, ...]:
    own = (getattr(summary, name) for name in _COLUMNS)
    prints = (getattr(summary.fingerprints, name) or None for name in _HASHES)
    return (*own, summary.trials and json.dumps(plain(summary.trials)), *prints)


def _insert(to: sqlite3.Connection, id: int, run: Sequence[Result]) -> None:
    data = _ENCODER.encode(run)
    digest = hashlib.sha256(data).hexdigest()
    packed = zstandard.ZstdCompressor(level=3).compress(data)
    to.execute("INSERT INTO runs VALUES (?,?,?,?,?)", (id, run[0].run, digest, len(data), packed))
    marks = ",".join("?" * (len(_ALL) + 1))
    rows = ((id, *_values(brief(each))) for each in run)
    to.executemany(f"INSERT INTO results VALUES ({marks})", rows)


def _seal(to: sqlite3.Connection, head: str) -> None:
    """The identity: SHA-256 of the head and of the hash of each run."""
    digest = hashlib.sha256(head.encode())
    for (each,) in to.execute("SELECT sha256 FROM runs ORDER BY id"):
        digest.update(each.encode())
    to.execute("DELETE FROM head")
    to.execute("INSERT INTO head VALUES (?,?)", (head, digest.hexdigest()))


def sqlite_write(path: Path, head: Document, runs: Iterator[list[Result]], count: int) -> None:
    to = sqlite3.connect(path)
    to.executescript(_SCHEMA)
    for id, run in zip(range(count), runs, strict=False):
        _insert(to, id, run)
        if id % 50 == 0:
            to.commit()
    _seal(to, json.dumps(plain(head)))
    to.execute("CREATE INDEX of_run ON results (run_id)")
    to.commit()
    to.close()


def sqlite_change(path: Path, fresh: dict[int, list[Result]]) -> None:
    to = sqlite3.connect(path)
    (head,) = to.execute("SELECT record FROM head").fetchone()
    for id, run in fresh.items():
        to.execute("DELETE FROM runs WHERE id = ?", (id,))
        to.execute("DELETE FROM results WHERE run_id = ?", (id,))
        _insert(to, id, run)
    _seal(to, head)
    to.commit()
    to.close()


def _connected(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)


def _contents(path: Path) -> Iterator[bytes]:
    """The JSON of each run, compared with its hash."""
    unpack = zstandard.ZstdDecompressor()
    rows = _connected(path).execute("SELECT sha256, size, record FROM runs ORDER BY id")
    for digest, size, packed in rows:
        data = unpack.decompress(packed, max_output_size=size)
        assert hashlib.sha256(data).hexdigest() == digest
        yield data


def sqlite_open(path: Path) -> None:
    """Compare each column with the records, and each run with its hash."""
    for _ in _checked(path):
        pass


def _checked(path: Path) -> Iterator[Sequence[Result]]:
    stored = _connected(path).execute(f"SELECT {','.join(_ALL)} FROM results ORDER BY rowid")
    for data in _contents(path):
        results = _RECORDS.decode(data)
        for each in results:
            assert stored.fetchone() == _values(brief(each))
        yield results


def sqlite_briefs(path: Path) -> int:
    """From the records: a column that differs cannot mislead."""
    return sum(1 for run in map(_RECORDS.decode, _contents(path)) for _ in map(brief, run))


def sqlite_details(path: Path, count: int) -> int:
    found = (each for run in map(_RECORDS.decode, _contents(path)) for each in run)
    return sum(1 for _ in islice(found, 0, count, max(1, count // SHOWN)))


def sqlite_latencies(path: Path) -> int:
    late = msgspec.json.Decoder(list[_Late])
    return sum(
        len(each.latencies_s)
        for run in map(late.decode, _contents(path))
        for each in run
        if each.requirement == "R1"
    )


def sqlite_full(path: Path) -> None:
    for results in _checked(path):
        _ENCODER.encode(results)


def sqlite_query(path: Path) -> None:
    _connected(path).execute(QUERY).fetchall()


def sqlite_columns(path: Path) -> None:
    """The columns alone, as a summary needs them."""
    _connected(path).execute(f"SELECT {','.join(_ALL)} FROM results").fetchall()


# Each step in a process of its own ----------------------------------------------------------------

Step = Callable[..., object]
STEPS: dict[str, tuple[Step, Step]] = {
    "open, verdicts checked": (parquet_open, sqlite_open),
    "briefs": (parquet_briefs, sqlite_briefs),
    f"{SHOWN} results in full": (parquet_details, sqlite_details),
    "latencies of R1": (parquet_latencies, sqlite_latencies),
    "all columns checked": (parquet_full, sqlite_full),
    "query": (parquet_query, sqlite_query),
    "summary": (parquet_summary, sqlite_columns),
}


def _timed(step: Step, *values: object) -> tuple[float, float]:
    """Seconds of CPU, and the most MB of memory."""
    start = time.process_time()
    step(*values)
    status = Path("/proc/self/status").read_text(encoding="ascii")
    most = int(status.partition("VmHWM:")[2].split()[0]) * 1024 / 1e6
    return time.process_time() - start, most


def _written(
    write: Step, path: Path, evidence: str, runs: int, requirements: int
) -> tuple[float, float]:
    head, original = _original(evidence)
    path.parent.mkdir(exist_ok=True)
    took = 0.0

    def made() -> Iterator[list[Result]]:
        nonlocal took  # making the results is not writing them
        for number in range(runs):
            start = time.process_time()
            run = run_of(original, number, requirements)
            took += time.process_time() - start
            yield run

    total, most = _timed(write, path, head, made(), runs)
    return total - took, most


def _changed(
    change: Step, path: Path, evidence: str, runs: int, requirements: int
) -> tuple[float, float]:
    _, original = _original(evidence)
    numbers = [round(n * runs / CHANGED) for n in range(CHANGED)]
    fresh = {number: run_of(original, number, requirements, seed=1) for number in numbers}
    return _timed(change, path, fresh)


def _original(path: str) -> tuple[Document, Result]:
    found = read_file(path)
    assert isinstance(found, EvidenceFile), found
    return replace(found.document, results=()), found.document.results[0]


def _size(path: Path) -> float:
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file()) / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("evidence", help="a JSON file with at least one result")
    parser.add_argument("--sizes", default="2000x15,1000x100", help="runs x requirements")
    parser.add_argument("--folder", help="for the files, default: a temporary one")
    options = parser.parse_args()
    alone = get_context("spawn")

    def row(name: str, first: Sequence[float], second: Sequence[float]) -> None:
        (a, memory_a), (b, memory_b) = first, second
        print(
            f"  {name:24} {a:7.2f} s {b:7.2f} s {b / a:6.2f}   {memory_a:5.0f} {memory_b:5.0f} MB",
            flush=True,
        )

    def apart(step: Callable[..., tuple[float, float]], *values: object) -> tuple[float, float]:
        with alone.Pool(1) as one:
            return one.apply(step, values)

    for size in options.sizes.split(","):
        runs, requirements = map(int, size.split("x"))
        with tempfile.TemporaryDirectory(dir=options.folder) as name:
            tables, file = Path(name, "tables"), Path(name, "file", "evidence.sqlite")
            shape = options.evidence, runs, requirements
            print(f"{runs} runs x {requirements} requirements: Parquet, SQLite, ratio, memory")
            row(
                "write",
                apart(_written, parquet_write, tables, *shape),
                apart(_written, sqlite_write, file, *shape),
            )
            a, b = _size(tables), _size(file)
            print(f"  {'size':24} {a:6.1f} MB {b:6.1f} MB {b / a:5.2f}")
            for title, (first, second) in STEPS.items():
                more = (runs * requirements,) if title.endswith("in full") else ()
                row(
                    title,
                    apart(_timed, first, tables, *more),
                    apart(_timed, second, file, *more),
                )
            row(
                f"{CHANGED} changed runs",
                apart(_changed, parquet_change, tables, *shape),
                apart(_changed, sqlite_change, file, *shape),
            )
            print(f"  {'size, then':24} {_size(tables):6.1f} MB {_size(file):6.1f} MB")


if __name__ == "__main__":
    main()
