"""Search for missions of the simulated robot that show the situations of tests.

The included scenarios are tried first, then variations of those in which a requirement came nearest
to its bounds. The audit of a mission tells which situations it shows, and FRET's verdict on the
whole run whether it satisfies or violates the requirement.

Source of the search: falsification by simulation, as in S-TaLiRo (Annpureddy et al., TACAS 2011);
with an evolution of scenarios in place of its optimizers.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, field, fields, replace
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import tomli_w

from compiler.files.records import UnsetType
from compiler.project.project import Project
from fretc.audit.evidence.schema import Result
from fretc.audit.many_logs import audit_log
from fretc.audit.plan import Plan, monitored_requirements, planned
from fretc.audit.pool import WorkerDied, map_processes
from fretc.campaigns.campaign import recorded
from fretc.testing.log_synthesis.variation import varied
from fretc.testing.suite import GoalResult, GoalStatus, Polarity, Suite
from fretish.classes.frozen import dataclass
from simulation.recording import TOPICS
from simulation.world.scenario import Expectations, Scenario, load, names

SEED = 1
"""Seed of all missions, so that the scenario alone determines the mission."""

Aim = tuple[str, str, Polarity]
"""A requirement, the key of a situation, and the polarity of the test."""


@dataclass(frozen=True, slots=True)
class Shown:
    """Result of the audit of a mission."""

    aims: frozenset[Aim]
    verdicts: Mapping[str, str]
    margins: Mapping[str, float]
    """Requirement → its least margin, relative to the bound; 0 after a violation."""


@dataclass(slots=True)
class Found:
    """Results of the search so far."""

    shown: dict[Aim, str] = field(default_factory=dict)
    """Goal → the first scenario that shows it."""
    scenarios: dict[str, Scenario] = field(default_factory=dict)
    """Scenarios that show a goal first, by name."""
    verdicts: dict[str, Mapping[str, str]] = field(default_factory=dict)
    runs: int = 0

    def new(self, scenario: str) -> tuple[Aim, ...]:
        """Goals that a scenario is the first to show."""
        return tuple(aim for aim, name in self.shown.items() if name == scenario)


def realizable_goals(suite: Suite, project: Project) -> tuple[tuple[Aim, ...], Mapping[str, str]]:
    """Goals that missions can show, and why those of other requirements cannot be recorded."""
    there = {topic.name for topic in TOPICS}
    declarations, why = project.declarations, {}
    for requirement in project.formalized:
        bound = declarations.propositions if declarations is not None else {}
        free = [name for name in requirement.watched if name not in bound]
        read = (
            declarations.restricted_to(requirement.watched).signals.values() if declarations else ()
        )
        absent = sorted({signal.path.topic for signal in read} - there)
        if free:
            why[requirement.id] = f"`{free[0]}` has no binding"
        elif absent:
            why[requirement.id] = f"the simulated robot has no topic `{absent[0]}`"
    aims = tuple(
        _aim(obligation) for obligation in suite.obligations if obligation.outcome is GoalStatus.MET
    )
    return tuple(aim for aim in aims if aim[0] not in why), why


def _aim(one: GoalResult) -> Aim:
    return one.requirement, one.situation, one.polarity


def search(
    project: Project,
    aims: Sequence[Aim],
    runs: int,
    jobs: int,
    found: Found,
    tell: Callable[[int, str], None],
) -> None:
    """Search for missions that show the goals.

    Args:
        project: project of the requirements.
        aims: goals of `realizable_goals`.
        runs: maximum number of missions.
        jobs: number of processes.
        found: collects the results mission by mission, so that an interruption loses nothing.
        tell: called with the number of missions, and a text about the shown goals.

    Raises:
        RuntimeError: the process of a mission was killed twice.
    """
    plan = planned(project)
    assert isinstance(plan, Plan), plan
    monitored_requirements(plan)  # Set before the processes start, because they inherit it.
    chance = Random(SEED)
    known: list[tuple[Scenario, Shown]] = []
    waiting = [load(name) for name in names()]
    with tempfile.TemporaryDirectory() as temporary:
        function = partial(shown, plan, Path(temporary))
        while found.runs < runs and any(aim not in found.shown for aim in aims):
            size = min(len(waiting) or 2 * jobs, runs - found.runs)
            batch, waiting = waiting[:size], waiting[size:]
            batch = batch or [
                _next(known, [a for a in aims if a not in found.shown], chance, number)
                for number in range(found.runs + 1, found.runs + size + 1)
            ]
            with closing(map_processes(function, batch, jobs)) as done:
                for index, one in done:
                    if isinstance(one, WorkerDied):
                        raise RuntimeError(f"the process of a mission was killed: {one}")
                    known.append((batch[index], one))
                    _note(found, aims, batch[index], one)
                    tell(found.runs, f"{len(found.shown)} of {len(aims)} shown")


def _note(found: Found, aims: Sequence[Aim], scenario: Scenario, one: Shown) -> None:
    found.runs += 1
    for aim in aims:
        if aim in one.aims and aim not in found.shown:
            found.shown[aim] = scenario.name
            found.scenarios[scenario.name] = scenario
            found.verdicts[scenario.name] = one.verdicts


def _next(
    known: Sequence[tuple[Scenario, Shown]], missing: Sequence[Aim], chance: Random, number: int
) -> Scenario:
    """A variation of a scenario that came near to a missing goal."""
    requirement, _, polarity = chance.choice(missing)

    def far(entry: tuple[Scenario, Shown]) -> float:
        margin = entry[1].margins.get(requirement, 1.0)
        return margin if polarity is Polarity.BROKEN else 0.0

    some = chance.sample(known, min(len(known), 4))
    parent, _ = min(some, key=far)
    return replace(varied(parent, chance), name=f"staged-{number}")


def shown(plan: Plan, folder: Path, scenario: Scenario) -> Shown:
    """Record and audit a mission; returns what it shows and removes its log."""
    log = folder / f"{scenario.name}.mcap"
    try:
        recorded(scenario, SEED, log)
        results = audit_log(plan, str(log)).results
    finally:
        log.unlink(missing_ok=True)
    return Shown(
        frozenset(aim for result in results for aim in _aims(result)),
        {result.requirement: str(result.verdict) for result in results},
        {result.requirement: _margin(result) for result in results},
    )


def _aims(result: Result) -> Iterator[Aim]:
    if isinstance(result.situations, UnsetType):
        return
    for key in result.situations.seen:
        yield result.requirement, key, Polarity.UNKNOWN
        if result.finite is not None:
            polarity = Polarity.KEPT if result.finite else Polarity.BROKEN
            yield result.requirement, key, polarity


def _margin(result: Result) -> float:
    """The margin; none for numbers that were crossed, or never known."""
    return min(
        (0.0 if t.margin is None else t.margin / (abs(t.bound) or 1.0) for t in result.thresholds),
        default=1.0,
    )


def confirmed(project: Project, text: str, aims: Sequence[Aim]) -> bool:
    """Whether the mission of a scenario file shows the goals, with the expected verdicts.

    Args:
        project: project of the requirements.
        text: content of the file.
        aims: goals that it must show.
    """
    plan = planned(project)
    assert isinstance(plan, Plan), plan
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary) / "again.toml"
        path.write_text(text, encoding="utf-8")
        scenario = load(str(path))
        again = shown(plan, Path(temporary), scenario)
    return again.aims.issuperset(aims) and scenario.expect.verdicts == again.verdicts


def text(
    scenario: Scenario, verdicts: Mapping[str, str], aims: Sequence[Aim], words: Mapping[Aim, str]
) -> str:
    """Scenario file with its goals, its changes, and the verdicts of its log."""
    lists: dict[str, list[str]] = {each.name: [] for each in fields(Expectations)}
    for id, verdict in verdicts.items():
        lists[verdict.replace(" ", "_")].append(id)
    own = replace(
        scenario,
        title=f"Found by search: {len(aims)} situations that no other scenario has shown",
        expect=Expectations(**{name: tuple(ids) for name, ids in lists.items()}),
        transport=dict(scenario.transport),
        name="custom",
    )
    comment = "".join(
        f"# {id}, {polarity}: {words[id, key, polarity]}\n" for id, key, polarity in aims
    )
    return f"{comment}\n{tomli_w.dumps(_changed(asdict(own), asdict(_PLAIN)))}"


_PLAIN = Scenario(title="", transport={})


def _changed(table: Mapping[str, Any], plain: Mapping[str, Any]) -> dict[str, Any]:
    """Settings that differ from an empty scenario."""
    changed: dict[str, Any] = {}
    for key, value in table.items():
        usual = plain.get(key)
        if value == usual or value is None:
            continue
        if isinstance(value, dict) and isinstance(usual, dict):
            changed[key] = _changed(value, usual)
        else:
            changed[key] = value
    return changed
