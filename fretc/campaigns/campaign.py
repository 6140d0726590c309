"""Campaigns: each scenario is simulated with each seed, and every log is audited and counted."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

from compiler.files.build_id import __version__
from compiler.targets.interceptor_options import ticks
from fretc.audit.many_logs import audit_log
from fretc.audit.measurements.binomial import highest, lowest
from fretc.audit.plan import monitored_requirements
from fretc.audit.pool import WorkerDied, map_processes
from fretc.campaigns.experiment import interceptor, plan, safety_function
from fretish.classes.frozen import dataclass
from monitors import kernel
from monitors.interceptor import Options
from simulation.mission import Mission, record
from simulation.nodes.safety import Interceptor as MakeInterceptor
from simulation.world.scenario import Interceptor, Scenario

CONFIDENCE = 0.95
"""Confidence level of the intervals."""


@dataclass(frozen=True, slots=True)
class MissionResult:
    """Result of one mission: what happened in the world, and the verdicts on its log."""

    scenario: str
    seed: int
    duration: float
    complete: bool
    stops: int
    measured_clearance: float
    """Metres."""
    true_clearance: float
    contacts: int
    latencies: tuple[float, ...]
    """Seconds from each request to the standstill."""
    distances: tuple[float, ...]
    """Metres that the robot moved between request and standstill."""
    verdicts: Mapping[str, str]
    wrong: Mapping[str, str]
    """The stated verdicts of the requirements whose verdict differs."""


@dataclass(frozen=True, slots=True)
class Share:
    """A proportion of runs; `low` and `high` are its Clopper-Pearson interval."""

    count: int
    runs: int
    low: float
    high: float

    def __str__(self) -> str:
        """Count, total and interval in percent."""
        return f"{self.count}/{self.runs} ({self.low * 100:.0f}-{self.high * 100:.0f} %)"


def share(count: int, runs: int) -> Share:
    """The exact interval of a binomial proportion: both of its bounds."""
    each = (1 + CONFIDENCE) / 2
    return Share(count, runs, lowest(count, runs, each), highest(count, runs, each))


def simulated(scenario: Scenario, seed: int, out: Path) -> MissionResult:
    """Record one mission, and audit its log."""
    return assessed(recorded(scenario, seed, out))


def assessed(mission: Mission) -> MissionResult:
    """Audit the log of a mission."""
    audit = audit_log(plan(), str(mission.path))
    return _run(mission, {r.requirement: r.verdict for r in audit.results})


def recorded(scenario: Scenario, seed: int, out: Path) -> Mission:
    """Record one mission with the compiled safety function."""
    decision = safety_function(scenario.safety.threshold)
    node = intercepted(scenario.interceptor)
    return record(out, scenario, node, seed, decision, versions={"fretc": __version__})


def intercepted(options: Interceptor) -> MakeInterceptor:
    """The emitted interceptor with the options of a scenario."""
    if not options.period:
        return partial(
            interceptor, Options(0, 0, 0, 0, event_driven=True, latching=options.latching)
        )

    def counted(seconds: float) -> int:
        return ticks(round(seconds * 10**9), round(options.period * 10**9))

    gate_options = Options(
        hold=counted(options.hold),
        stop_timeout=counted(options.safety_timeout),
        scan_timeout=0,
        command_timeout=counted(options.command_timeout),
        latching=options.latching,
    )
    return partial(interceptor, gate_options)


def _run(mission: Mission, verdicts: Mapping[str, str]) -> MissionResult:
    stated = mission.scenario.expect.verdicts
    stood = [stop for stop in mission.stops if stop.latency is not None]
    return MissionResult(
        scenario=mission.scenario.name,
        seed=mission.seed,
        duration=mission.duration,
        complete=mission.goals_reached == mission.goals_total,
        stops=len(mission.stops),
        measured_clearance=mission.measured_clearance,
        true_clearance=mission.true_clearance,
        contacts=mission.contacts,
        latencies=tuple(stop.latency for stop in stood if stop.latency is not None),
        distances=tuple(stop.distance for stop in stood),
        verdicts=verdicts,
        wrong={id: verdict for id, verdict in stated.items() if verdicts.get(id) != verdict},
    )


def campaign(
    scenarios: Sequence[Scenario],
    seeds: Sequence[int],
    jobs: int,
    folder: Path | None = None,
    tell: Callable[[int], None] = lambda done: None,
) -> list[MissionResult]:
    """Run every scenario with every seed, scenario by scenario.

    Args:
        scenarios: any number of scenarios.
        seeds: the seeds for each scenario.
        jobs: number of processes.
        folder: folder for the logs; None: the logs are removed.
        tell: called with the number of finished missions.

    Raises:
        RuntimeError: the process of a mission was killed twice.
    """
    monitored_requirements(plan())  # Set before the processes start, because they inherit it.
    things = [(scenario, seed) for scenario in scenarios for seed in seeds]
    runs: dict[int, MissionResult] = {}
    with _place(folder, things) as logs:
        function = partial(_one, logs, folder is not None)
        with closing(map_processes(function, things, jobs)) as done:
            for index, run in done:
                if isinstance(run, WorkerDied):
                    raise RuntimeError(f"the process of a mission was killed: {run}")
                runs[index] = run
                tell(len(runs))
    return [runs[index] for index in sorted(runs)]


@contextmanager
def _place(folder: Path | None, things: Sequence[tuple[Scenario, int]]) -> Iterator[Path]:
    """Folder for the logs. Files of a killed process are removed."""
    if folder is None:
        with tempfile.TemporaryDirectory() as temporary:
            yield Path(temporary)
        return
    try:
        yield folder
    finally:
        for scenario, seed in things:
            for partly in folder.glob(f".{_name(scenario, seed)}.*.partial"):
                partly.unlink(missing_ok=True)


def _one(folder: Path, keep: bool, thing: tuple[Scenario, int]) -> MissionResult:
    scenario, seed = thing
    out = folder / _name(scenario, seed)
    run = simulated(scenario, seed, out)
    if not keep:
        out.unlink()
    return run


def _name(scenario: Scenario, seed: int) -> str:
    return f"{scenario.name}-{seed}.mcap"


def table(runs: Sequence[MissionResult]) -> str:
    """Table with a line for each scenario, then the violations by requirement and scenario."""
    groups: dict[str, list[MissionResult]] = {}
    for run in runs:
        groups.setdefault(run.scenario, []).append(run)
    rows = [_HEAD, *(_row(name, group) for name, group in groups.items())]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
    lines = ["  ".join(c.ljust(w) for c, w in zip(r, widths, strict=True)).rstrip() for r in rows]
    return "\n".join([*lines, "", *_violations(groups)]) + "\n"


_HEAD = (
    "scenario",
    "as stated",
    "complete",
    "contact in",
    "stops",
    "seen cm",
    "true cm",
    "stop s",
    "stop cm",
)


def _row(name: str, runs: Sequence[MissionResult]) -> tuple[str, ...]:
    latencies = [latency for run in runs for latency in run.latencies]
    distances = [distance for run in runs for distance in run.distances]
    return (
        name,
        f"{sum(not run.wrong for run in runs)}/{len(runs)}",
        f"{sum(run.complete for run in runs)}/{len(runs)}",
        str(share(sum(run.contacts > 0 for run in runs), len(runs))),
        _range([run.stops for run in runs]),
        f"{min(run.measured_clearance for run in runs) * 100:.1f}",
        f"{min(run.true_clearance for run in runs) * 100:.1f}",
        f"{max(latencies):.2f}" if latencies else "-",
        f"{max(distances) * 100:.1f}" if distances else "-",
    )


def _range(values: Sequence[int]) -> str:
    low, high = min(values), max(values)
    return str(low) if low == high else f"{low}-{high}"


def _violations(groups: Mapping[str, Sequence[MissionResult]]) -> Iterator[str]:
    yield f"violated in, with {CONFIDENCE * 100:.0f} % intervals (Clopper-Pearson):"
    for name, runs in groups.items():
        counts = {
            id: sum(run.verdicts[id] == kernel.VIOLATED for run in runs) for id in runs[0].verdicts
        }
        shares = [f"{id} {share(count, len(runs))}" for id, count in counts.items() if count]
        yield f"  {name}: {', '.join(shares) or 'none'}"
    for run in (run for runs in groups.values() for run in runs if run.wrong):
        differences = ", ".join(
            f"{i} is {run.verdicts.get(i)}, not {v}" for i, v in run.wrong.items()
        )
        yield f"not as expected: {run.scenario}, seed {run.seed}: {differences}"
