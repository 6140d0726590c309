"""The events of a watch are those of one that decodes and evaluates everything in general ways."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import pytest

from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.logs.stream import SampleStream
from fretc.watch.json_lines import line
from fretc.watch.requirement_monitors import RequirementMonitors
from fretc.watch.session import Session
from fretc.watch.single_messages import SingleMessages
from fretc.watch.sources.log import Log
from fretc.watch.sources.source import Arrival, ConnectionLost, Idle, Missed, Reconnected
from fretc.watch.watch import Watch
from fretish.diagnostics.messages import diagnostic
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.verdicts import Truth
from monitors.stop_supervisor import State
from tests.effort import FULL, some

ROOT = Path(__file__).parents[3]
LOG = ROOT / "traces" / "mission-seed15.mcap"
STAMPS = 'time = "header.stamp"\nlateness = "20 ms"'
CASES = [
    (folder, time, seed)
    for folder in ("requirements", "requirements/mission")
    for time in ('time = "log_time"', STAMPS)
    for seed in range(4)
]
Item = Arrival | Idle | Missed | ConnectionLost | Reconnected


@cache
def plan_of(folder: str, time: str) -> Plan:
    with TemporaryDirectory() as name:
        for file in filter(Path.is_file, (ROOT / folder).glob("*")):
            text = file.read_text(encoding="utf-8").replace('time = "log_time"', time, 1)
            Path(name, file.name).write_text(text, encoding="utf-8")
        plan = planned(read_project(Path(name)))
    assert isinstance(plan, Plan), plan
    return plan


@cache
def arrivals(topics: tuple[str, ...], count: int) -> list[Arrival]:
    found: list[Arrival] = []
    for each in Log(str(LOG), follow=False).arrivals(topics):
        if isinstance(each, Arrival):
            found.append(each)
        if len(found) == count:
            break
    return found


def mutated(whole: Sequence[Arrival], random: Random) -> Iterator[Item]:
    """Messages that are lost, damaged, sent twice or received late, and a lost connection."""
    received = 0
    lost = random.randrange(len(whole))
    for i, each in enumerate(whole):
        chance = random.random()
        delay = random.choice([10**6, 3 * 10**7, 4 * 10**8]) if chance < 0.02 else 0
        received = max(received, each.log_time + delay)
        arrival = replace(each, log_time=received)
        if i == lost:
            until = arrival.log_time
            yield ConnectionLost(until - 10**7, diagnostic("run_not_recorded"))
            yield Reconnected(until - 10**7, until)
        if chance > 0.98:
            yield Missed(received - 10**6, received, 1)
        elif chance > 0.96:
            at = random.randrange(len(each.payload))
            damaged = bytearray(each.payload)
            damaged[at] ^= 1 << random.randrange(8)
            yield replace(arrival, payload=bytes(damaged))
        elif chance > 0.94:
            yield replace(arrival, payload=each.payload[: random.randrange(len(each.payload))])
        elif chance > 0.92:
            yield arrival
            yield arrival
        elif chance > 0.04:
            yield arrival
        if chance > 0.995:
            yield Idle(arrival.log_time)


def told(plan: Plan, items: Iterable[Item]) -> list[Mapping[str, Any]]:
    watch = Watch(plan)
    events = [each for item in items for each in watch.take(item)]
    return [line(each) for each in [*events, *watch.finish()]]


@contextmanager
def in_general_ways() -> Iterator[None]:
    def statuses(self: RequirementMonitors) -> tuple[RequirementStatus, ...]:
        return tuple(each for monitor in self.monitors for each in monitor.statuses())

    def pending(
        self: RequirementMonitors, rows: Iterable[Mapping[str, Truth]] = ()
    ) -> tuple[Truth, ...]:
        ahead = tuple(rows)
        return tuple(
            each.obligation_pending
            for monitor in self.monitors
            for each in (monitor.statuses_after(ahead) if ahead else monitor.statuses())
        )

    states = Session.states

    def anew(self: Session, *, ahead: bool = True) -> tuple[State, ...]:
        self._basis = None
        return states(self, ahead=ahead)

    with ExitStack() as stack:
        for owner, name, function in (
            (RequirementMonitors, "statuses", statuses),
            (RequirementMonitors, "obligation_pending", pending),
            (Session, "states", anew),
            (SingleMessages, "read", lambda self, payload: None),
            (SampleStream, "_truth_in_lists", lambda self, times: {}),
        ):
            stack.enter_context(patch.object(owner, name, function))
        yield


@pytest.mark.slow
@pytest.mark.parametrize(("folder", "time", "seed"), some(CASES, 5))
def test_the_events_are_those_of_the_general_ways(folder: str, time: str, seed: int) -> None:
    plan = plan_of(folder, time)
    count = 700 if FULL or len(plan.claims) == 1 else 250
    whole = arrivals(tuple(Watch(plan).topics), count)
    items = [*mutated(whole, Random(seed))] if seed else whole
    fast = told(plan, items)
    with in_general_ways():
        assert fast == told(plan, items)
    assert len(fast) > len(plan.claims)
