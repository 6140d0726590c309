"""How large the report is, and the time and memory it takes, from evidence that is there already.

Each report is made in a process of its own, once from a JSON file and once from a store.
"""

from __future__ import annotations

import argparse
import json
import random
import tempfile
import time
from collections.abc import Iterator, Mapping
from itertools import product
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.figures import Figure
from compiler.files.build_id import __version__
from compiler.files.records import decoded
from compiler.files.text_files import sha256
from compiler.formalization.record import wording
from compiler.project.folder import load
from compiler.project.project import Project
from fretc.audit.evidence.schema import SCHEMA, EvidenceDocument, Result
from fretc.audit.evidence.verdict_inputs import BINDINGS as BOUND
from fretc.audit.evidence.verdict_inputs import of_all
from fretc.audit.project_inputs import all_verdict_inputs
from fretc.audit.store.container import packed
from fretc.audit.store.writer import StoreFile, complete, publish
from fretc.report.make import make
from fretc.start import collect_rarely

BINDINGS = """\
[clock]
time = "log_time"
tick = "100 ms"
end = "inconclusive"

[signal.clearance]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
unit = "m"
max_age = "300 ms"

[signal.vx]
path = "/odom.twist.twist.linear.x"
type = "nav_msgs/Odometry"
unit = "m/s"
max_age = "100 ms"

[proposition.near]
text = "an obstacle is near"
expr = "clearance < 5 cm"
role = "input"
kind = "belief"
agg = "any"

[proposition.stopped]
text = "the robot does not move"
expr = "abs(vx) < 0.01 m/s"
role = "output"
kind = "physical"
agg = "last"
"""
TICKS = 6_000
"""Ten minutes."""


def project(folder: Path, requirements: int) -> Project:
    """So many requirements, ten to a hazard."""
    hazards = [
        f'["HAZ-{n}"]\ntitle = "Hazard {n}"\nseverity = "critical"\n'
        for n in range((requirements + 9) // 10)
    ]
    (folder / "hazards.toml").write_text("\n".join(hazards), encoding="utf-8")
    (folder / "bindings.toml").write_text(BINDINGS, encoding="utf-8")
    paths = []
    for n in range(requirements):
        header = (
            f'id = "R{n}"\ntitle = "Stop in time, case {n}"\nparents = ["HAZ-{n // 10}"]\n'
            'text = "The robot must stop when something is near."\nstatus = "approved"\n'
        )
        sentence = f"whenever near the robot shall within {10 + n} ticks satisfy stopped"
        paths.append(folder / f"r{n}.fret")
        paths[-1].write_text(f"+++\n{header}+++\n{sentence}\n", encoding="utf-8")
    names = [str(path) for path in paths]
    return load(names, str(folder / "bindings.toml"), str(folder / "hazards.toml"))


def evidence(known: Project, runs: int, share: float) -> dict[str, Any]:
    """What an audit would have written: of each requirement a share of runs is violated."""
    return {**head(known), "results": [each for run in results(known, runs, share) for each in run]}


def head(known: Project) -> dict[str, Any]:
    """The same without its results."""
    inputs_of = all_verdict_inputs(known)
    bound = {
        requirement.id: inputs_of[requirement.entry][BOUND] for requirement in known.formalized
    }
    texts = [
        {
            "id": requirement.id,
            "sentence": wording(requirement.entry),
            "sha256": requirement.fingerprint,
        }
        for requirement in known.formalized
    ]
    bindings = {"file": "b", "sha256": of_all(bound)}
    return {"schema": SCHEMA, "fretc": __version__, "bindings": bindings, "requirements": texts}


def results(known: Project, runs: int, share: float) -> Iterator[list[dict[str, Any]]]:
    """The results of each run."""
    choose, inputs_of = random.Random(1), all_verdict_inputs(known)
    for run in range(runs):
        yield [
            _result(
                choose,
                requirement,
                inputs_of[requirement.entry],
                run,
                violated=choose.random() < share,
            )
            for requirement in known.formalized
        ]


def _moment(tick: int) -> dict[str, Any]:
    return {"tick": tick, "ns": 10**9 + tick * 10**8, "seconds": tick / 10}


def _result(
    choose: random.Random,
    requirement: Any,
    verdict_inputs: Mapping[str, str],
    run: int,
    *,
    violated: bool,
) -> dict[str, Any]:
    triggers = sorted(choose.sample(range(TICKS - 200), 40))
    broken = triggers[:8] if violated else []
    late = [round(choose.uniform(0, 0.9), 1) for _ in triggers[len(broken) :]]
    clear = choose.uniform(0.06, 2)
    return {
        "run": f"runs/{run:04}.mcap",
        "requirement": requirement.id,
        "verdict": "violated" if violated else "satisfied",
        "finite": not violated,
        "reason": "broken 8 times" if violated else "held, 40 triggers",
        "clock": "100 ms, by log_time",
        "ticks": TICKS,
        "start_ns": 10**9,
        "end_ns": 10**9 + TICKS * 10**8,
        "states": [],
        "answers": [],
        "triggers": [_moment(tick) for tick in triggers],
        "violations": [_violation(choose, tick, requirement.ticks or 0) for tick in broken],
        "unknown": [],
        "open": [],
        "latencies_s": late,
        "exercised": len(triggers),
        "latency_median_s": median(late),
        "latency_max_s": max(late),
        "propositions": {},
        "thresholds": [
            _threshold("near", "clearance", 0.05, "m", None if violated else clear - 0.05),
            _threshold("stopped", "abs(vx)", 0.01, "m/s", None),
        ],
        "units": {"clearance": "m", "vx": "m/s"},
        "assumptions": [],
        "hashes": {"log": sha256(str(run)), **verdict_inputs},
        "health": {
            "intact": True,
            "size": 12_345_678,
            "checked": None,
            "gaps": [],
            "findings": [],
            "topics": {f"/topic{n}": _topic() for n in range(12)},
        },
    }


def _topic() -> dict[str, Any]:
    return {
        "type": "nav_msgs/msg/Odometry",
        "count": 30_000,
        "first_ns": 10**9,
        "last_ns": 601 * 10**9,
        "longest_gap_ns": 40_000_000,
        "median_period_ns": 20_000_000,
        "out_of_order": 0,
        "equal_stamps": 0,
        "unstamped": 0,
        "zero_stamps": 0,
        "clock_jumps": 0,
    }


def _threshold(
    proposition: str, signal: str, bound: float, unit: str, margin: float | None
) -> dict[str, Any]:
    return {
        "proposition": proposition,
        "signal": signal,
        "operator": "<",
        "bound": bound,
        "unit": unit,
        "least": bound + margin if margin is not None else 0.0,
        "greatest": 3.0,
        "comparison": "crossed" if margin is None else "false",
        "margin": margin,
        "nearest": {"ns": 10**9, "seconds": 0.0},
    }


def _violation(choose: random.Random, trigger: int, horizon: int) -> dict[str, Any]:
    first, start = trigger + horizon, 10**9 + trigger * 10**8 - 10**9
    end = 10**9 + (trigger + horizon) * 10**8 + 10**9
    times = [start + (end - start) * i // 49 for i in range(50)]
    samples = {
        name: {"times_ns": times, "values": [round(choose.uniform(0, most), 4) for _ in times]}
        for name, most in (("clearance", 0.3), ("vx", 0.4))
    }
    return {
        "first_tick": first,
        "last_tick": first + 3,
        "start_ns": 10**9 + first * 10**8,
        "end_ns": 10**9 + (first + 3) * 10**8,
        "start_s": first / 10,
        "end_s": (first + 3) / 10,
        "trigger": _moment(trigger),
        "deadline": _moment(first),
        "missing": "stopped",
        "values": {"clearance": 0.0318, "vx": 0.21},
        "window": {"start_ns": start, "end_ns": end, "samples": samples},
    }


# Each in a process of its own ---------------------------------------------------------------------

JSON, STORE = "evidence.json", "evidence"
SHARE = 0.05
"""Of runs that are violated, if a size does not say it."""
SIZES = "50x20,50x20x1,50x100,1000x20,1000x100,15x10000"


def written(folder: Path, requirements: int, runs: int, share: float, form: str) -> None:
    """Write the project and its evidence, a run after the other."""
    known = project(folder, requirements)
    of_runs = results(known, runs, share)
    if form == JSON:
        with (folder / JSON).open("w", encoding="utf-8") as file:
            file.write(json.dumps(head(known))[:-1] + ', "results": [')
            for number, run in enumerate(of_runs):
                file.write(("," if number else "") + json.dumps(run)[1:-1])
            file.write("]}")
        return
    (folder / STORE).mkdir()
    store = StoreFile(folder / STORE / "unfinished-1.sqlite")
    for place, run in enumerate(of_runs):
        store.put(packed(place, decoded(run, list[Result])))
    document = decoded({**head(known), "results": []}, EvidenceDocument)
    complete(store.path, document, store.close())
    publish(store.path)


def report(folder: Path, requirements: int, form: str) -> tuple[float, float, float, float]:
    """Make the page: seconds of CPU, MB of memory with nothing read and at most, MB of the page."""
    paths = [str(folder / f"r{n}.fret") for n in range(requirements)]
    collect_rarely()
    known = load(paths, str(folder / "bindings.toml"), str(folder / "hazards.toml"))
    before, start = _most_memory(), time.process_time()
    page = make(known, str(folder / form)).html
    assert page is not None
    return time.process_time() - start, before, _most_memory(), len(page.encode()) / 1e6


def measured(size: str, form: str) -> tuple[float, float, float, float, float]:
    """MB of evidence, then what `report` gives, in processes of their own."""
    requirements, runs, *share = size.split("x")
    alone = get_context("spawn")
    with tempfile.TemporaryDirectory() as name:
        folder, violated = Path(name), float(share[0]) if share else SHARE
        with alone.Pool(1) as one:
            one.apply(written, (folder, int(requirements), int(runs), violated, form))
        read = sum(file.stat().st_size for file in _files(folder / form)) / 1e6
        with alone.Pool(1) as one:
            return read, *one.apply(report, (folder, int(requirements), form))


def figures() -> Iterator[Figure]:
    what = "report of 100 requirements in 1 000 runs"
    _, took, _, most, _ = measured("100x1000", STORE)
    yield Figure(what, took, "s of CPU", 8)
    yield Figure(what, most, "MB of memory", 200)


def _most_memory() -> float:
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024 / 1e6


def main() -> None:
    """Print a line for each size and form."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", default=SIZES, help="requirements x runs x violated share")
    parser.add_argument("--forms", default=f"{JSON},{STORE}")
    args = parser.parse_args()
    print(
        f"{'requirements x runs':>20} {'violated':>9}  {'evidence':>22} {'page':>8} {'CPU':>8}",
        end="",
    )
    print(f" {'memory':>8}, before")
    for size, form in product(args.sizes.split(","), args.forms.split(",")):
        requirements, runs, *share = size.split("x")
        violated = float(share[0]) if share else SHARE
        read, took, before, most, page = measured(size, form)
        print(
            f"{f'{requirements} x {runs}':>20} {violated:>9.0%}  {form:>13} {read:>5.0f} MB "
            f"{page:>5.2f} MB {took:>6.1f} s {most:>5.0f} MB, {before:.0f} MB",
            flush=True,
        )


def _files(path: Path) -> list[Path]:
    return [each for each in path.rglob("*") if each.is_file()] if path.is_dir() else [path]


if __name__ == "__main__":
    main()
