"""A watch: messages a second that it takes, against an audit of the log; a look at obligations.

    python -m benchmarks.watching [LOG]

Prints CPU time; no test asserts it.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.figures import RUNS, Figure
from compiler.targets.python import monitor
from fretc.api.requirements import read_project
from fretc.audit.one_log import audit
from fretc.audit.plan import Plan, monitored_requirements, planned
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.start import collect_rarely
from fretc.watch.session import Session
from fretc.watch.sources.log import Log
from fretc.watch.sources.source import Arrival
from fretc.watch.watch import Watch
from monitors.loading import executed

ROOT = Path(__file__).parent.parent
LOG = str(ROOT / "traces" / "mission-seed15.mcap")
LIMITS = {"requirements": 20_000, "requirements/mission": 5_000}
"""The least messages a second."""
CALLS = 20_000
"""Calls of `statuses` that are timed."""


@contextmanager
def requirements(folder: Path, time_: str) -> Iterator[Path]:
    """The folder, with another clock."""
    with TemporaryDirectory() as name:
        for file in filter(Path.is_file, folder.glob("*")):
            shutil.copy(file, name)
        bindings = Path(name, "bindings.toml")
        bindings.write_text(
            bindings.read_text(encoding="utf-8").replace('time = "log_time"', time_, 1),
            encoding="utf-8",
        )
        yield Path(name)


def taken(plan: Plan, arrivals: list[Arrival]) -> tuple[float, float]:
    """Seconds of a session that judges, and of a whole watch, which also looks what is pending."""
    session, start = Session(plan), time.process_time()
    for each in arrivals:
        session.arrive(each)
    judged = time.process_time() - start
    watch, start = Watch(plan), time.process_time()
    for each in arrivals:
        for _ in watch.take(each):
            pass
    return judged, time.process_time() - start


def audited(plan: Plan, log: str) -> float:
    start = time.process_time()
    recording = read(log, plan.declarations, list(plan.declarations.signals))
    assert isinstance(recording, Recording)
    audit(recording, plan.declarations, monitored_requirements(plan))
    return time.process_time() - start


def pending(folder: Path) -> float:
    """Nanoseconds of one call, of the first requirement."""
    requirement = read_project(folder).formalized[0]
    module = executed(monitor.text(requirement), "pending")
    running = module.MONITOR()
    running.advance([dict.fromkeys(running.PROPOSITIONS, True)])
    start = time.process_time()
    for _ in range(CALLS):
        [each.obligation_pending for each in running.statuses()]
    return (time.process_time() - start) / CALLS * 1e9


def arrivals_of(plan: Plan, log: str) -> list[Arrival]:
    items = Log(log, follow=False).arrivals(Watch(plan).topics)
    return [each for each in items if isinstance(each, Arrival)]


def figures(log: str = LOG) -> Iterator[Figure]:
    collect_rarely()
    for name, limit in LIMITS.items():
        with requirements(ROOT / name, 'time = "log_time"') as folder:
            plan = planned(read_project(folder))
            assert isinstance(plan, Plan), plan
            arrivals = arrivals_of(plan, log)
            rates = [len(arrivals) / taken(plan, arrivals)[1] for _ in range(RUNS)]
        value = statistics.median(rates)
        yield Figure(f"watch of {name}", value, "messages a second", limit, at_least=True)


def main() -> None:
    collect_rarely()
    log = sys.argv[1] if len(sys.argv) > 1 else LOG
    print(f"{'':40}{'messages':>9}{'audit':>12}{'session':>12}{'watch':>12}{'pending':>10}")
    for name in ("requirements", "requirements/mission"):
        for clock in ('time = "log_time"', 'time = "header.stamp"\nlateness = "200 ms"'):
            with requirements(ROOT / name, clock) as folder:
                plan = planned(read_project(folder))
                assert isinstance(plan, Plan), plan
                arrivals = arrivals_of(plan, log)
                seconds = audited(plan, log), *taken(plan, arrivals)
                rates = "".join(f"{len(arrivals) / each:>10.0f}/s" for each in seconds)
                title = f"{name}, {clock.split()[2]}"
                print(f"{title:40}{len(arrivals):>9}{rates}{pending(folder):>7.0f} ns", flush=True)


if __name__ == "__main__":
    main()
