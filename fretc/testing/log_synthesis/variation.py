"""Random variations of a scenario: moved objects, a walking person, and faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from random import Random

from simulation.world.scenario import (
    Interceptor,
    Operator,
    Outage,
    Scenario,
    Transport,
    Walker,
)
from simulation.world.scene import STORE, Barrel

Change = Callable[[Scenario, Random], Scenario]
_TOPICS = ("/scan", "/odom", "/gwendolen_control", "/cmd_vel_filtered")
_AWAY = 0.8
"""Minimum distance in metres between a moved obstacle and the robot's start."""


def varied(scenario: Scenario, chance: Random) -> Scenario:
    """The scenario with one to three changes, and without expected results."""
    for change in chance.sample(CHANGES, chance.randint(1, 3)):
        scenario = change(scenario, chance)
    title = "A variation of a mission"
    return replace(scenario, title=title, text="", expect=type(scenario.expect)())


def _moved(scenario: Scenario, chance: Random) -> Scenario:
    barrel = chance.choice(
        [obstacle.name for obstacle in STORE.obstacles if isinstance(obstacle, Barrel)]
    )
    place = _place(chance)
    moved = {**scenario.store.moved, barrel: place}
    return replace(scenario, store=replace(scenario.store, moved=moved))


def _walked(scenario: Scenario, chance: Random) -> Scenario:
    end = _place(chance)
    walker = Walker(
        start=_place(chance),
        end=end,
        near=end,
        within=round(chance.uniform(0.5, 2.0), 2),
        speed=round(chance.uniform(0.3, 1.5), 2),
        stays=round(chance.uniform(0.5, 25.0), 1),
    )
    return replace(scenario, store=replace(scenario.store, walker=walker))


def _place(chance: Random) -> tuple[float, float]:
    """A position on the way of the robot, or beside it."""
    stops = [STORE.start, *STORE.goals]
    at = chance.randrange(len(stops) - 1)
    share = chance.uniform(0.1, 0.9)
    here, there = stops[at], stops[at + 1]
    x = here.x + share * (there.x - here.x) + chance.uniform(-0.8, 0.8)
    y = here.y + share * (there.y - here.y) + chance.uniform(-0.8, 0.8)
    x, y = min(max(x, 0.4), STORE.length - 0.4), min(max(y, 0.4), STORE.width - 0.4)
    if abs(x - STORE.start.x) < _AWAY and abs(y - STORE.start.y) < _AWAY:
        x += 2 * _AWAY
    return round(x, 2), round(y, 2)


def _planned(scenario: Scenario, chance: Random) -> Scenario:
    planner = replace(
        scenario.planner,
        margin=round(chance.uniform(0.1, 0.7), 2),
        speed=round(chance.uniform(0.15, 0.6), 2),
        turn=round(chance.uniform(0.1, 0.4), 2),
        slow=round(chance.uniform(0.1, 0.3), 2),
    )
    return replace(scenario, planner=planner)


def _silent(scenario: Scenario, chance: Random) -> Scenario:
    outage = Outage(
        at=round(chance.uniform(1, 120), 1),
        seconds=round(chance.choice((0.3, 0.6, 2.0, 8.0)), 1),
        says=chance.choice(("nothing", "nan")),
    )
    lidar = replace(scenario.lidar, outages=(*scenario.lidar.outages, outage))
    return replace(scenario, lidar=lidar)


def _late(scenario: Scenario, chance: Random) -> Scenario:
    late = chance.choice((0.05, 0.1, 0.15, 0.2, 0.3, 0.6))
    return replace(scenario, safety=replace(scenario.safety, late=late))


def _near(scenario: Scenario, chance: Random) -> Scenario:
    threshold = chance.choice((0.01, 0.03, 0.05, 0.08, 0.15))
    return replace(scenario, safety=replace(scenario.safety, threshold=threshold))


def _dead(scenario: Scenario, chance: Random) -> Scenario:
    return replace(scenario, safety=replace(scenario.safety, dies_at=float(chance.randint(2, 90))))


def _alone(scenario: Scenario, chance: Random) -> Scenario:
    return replace(scenario, operator=Operator(present=not scenario.operator.present))


def _intercepted(scenario: Scenario, chance: Random) -> Scenario:
    latching = chance.random() < 0.3
    hold = chance.choice((0.0, 0.1, 0.2, 1.0))
    return replace(scenario, interceptor=Interceptor(hold=hold, latching=latching))


def _carried(scenario: Scenario, chance: Random) -> Scenario:
    way = Transport(
        delay=chance.choice((0.0, 0.05, 0.15)),
        loss=chance.choice((0.0, 0.05, 0.3)),
        swap=chance.choice((0.0, 0.1)),
    )
    transport = {**scenario.transport, chance.choice(_TOPICS): way}
    return replace(scenario, transport=transport)


CHANGES: Sequence[Change] = (
    _moved,
    _walked,
    _planned,
    _silent,
    _late,
    _near,
    _dead,
    _alone,
    _intercepted,
    _carried,
)
