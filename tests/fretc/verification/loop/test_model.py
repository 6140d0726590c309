"""Whatever a naive simulation of the texts does, the model of the loop can do too."""

import random
from typing import Any, NamedTuple

import pytest

from fretc.verification.interceptor.machine import Event
from fretc.verification.loop.actuation_model import ActuationAssumptions, ActuationState
from fretc.verification.loop.model import Environment, Node
from fretc.verification.loop.search import Case, Parts
from monitors.interceptor import Options
from monitors.loading import load
from tests.effort import FULL
from tests.loops import LATCH, WITHIN, case, interceptor_options

MOVE, STAND = 2.5, 0.0
"""Metres a second: what the planner of the simulation says."""
PERIOD = 10
"""Units of time to a cell; messages come at any of them."""


class Row(NamedTuple):
    """What was sampled at a tick, and how everything stood before the next."""

    near: bool
    stopped: bool
    request: bool
    fields: tuple[Any, ...]
    moving: bool
    losses: int


class Simulation:
    """The texts in fine time: a planner, a lossy channel, a timer of any phase, wheels."""

    def __init__(self, known: Case, seed: int) -> None:
        self.choose = random.Random(seed)
        self.channel = known.channel
        self.monitor: Any = load("monitor", known.safety)
        self.core: dict[str, Any] = {}
        exec(compile(known.interceptor, "core", "exec", dont_inherit=True), self.core)
        settings = {name: getattr(known.settings, name) for name in vars(known.settings)}
        self.options = self.core["Options"](**settings)
        self.state = self.core["initial"](self.options)
        self.phase = self.choose.randint(1, PERIOD)
        self.since: int | None = -(10**6)
        self.flying: list[tuple[int, bool]] = []
        self.losses, self.last, self.now = 0, False, 0
        self.ticks, self.spoke = 0, 0
        self.regular = seed % 2 == 0

    def tick(self) -> Row:
        """Sample, request, and let the time of one tick pass."""
        near = self.choose.random() < 0.3
        stopped = self._stands()
        self.monitor.step(near=near, stopped=stopped)
        (signals,) = self.monitor.certain.signals()
        request = bool(signals.trigger or signals.obligation_pending)
        self._send(request)
        end = self.now + self.channel.cells * PERIOD
        commands = sorted(
            self.choose.randint(self.now + 1, end) for _ in range(self.choose.randrange(4))
        )
        if self.channel.punctual and not commands:
            commands = [end]
        self._pass(end, commands)
        values = tuple(getattr(self.state, name) for name in vars(self.state))
        return Row(near, stopped, request, values, self.since is None, self.losses)

    def _stands(self) -> bool:
        if self.since is None:
            return False
        passed = self.now - self.since
        # It brakes as fast as it can, and no faster.
        return passed >= self.channel.braking * PERIOD

    def _send(self, request: bool) -> None:
        tick, self.ticks = self.ticks, self.ticks + 1
        if self.channel.edge and request == self.last and not self._beats(tick):
            return
        self.last, self.spoke = request, tick
        if self.losses < self.channel.lost and self.choose.random() < 0.5:
            self.losses += 1
            return
        self.losses = 0
        latest = self.now + self.channel.latency * PERIOD
        earliest = max([self.now, *(due for due, _ in self.flying)])
        self.flying.append((self.choose.randint(min(earliest, latest), latest), request))

    def _beats(self, tick: int) -> bool:
        """At its own times, whatever the messages between; or counted from the last message."""
        beat = self.channel.heartbeat
        if not beat:
            return False
        return tick % beat == 0 if self.regular else tick - self.spoke >= beat

    def _pass(self, end: int, commands: list[int]) -> None:
        core, start = self.core, self.now
        while True:
            while self.flying and self.flying[0][0] <= self.now:
                self._hear(core["StopHeard"](self.flying.pop(0)[1]))
            while commands and commands[0] <= self.now:
                speed = self.choose.choice((MOVE, MOVE, STAND))
                self._hear(core["CommandHeard"](core["Velocity"](speed)))
                commands.pop(0)
            if self.now > start and self.now % PERIOD == self.phase % PERIOD:
                self._hear(core["TimerRang"]())
            if self.now == end:
                return
            self.now += 1

    def _hear(self, event: Any) -> None:
        self.state, output = self.core["step"](self.state, event, self.options)
        if output is not None and any(output):
            self.since = None
        elif output is not None and self.since is None:
            self.since = self.now


def follows(known: Case, rows: list[Row]) -> None:
    """Each row is a step of the model, from one of the nodes that the rows before can be in."""
    parts = Parts.of(known)
    loop = parts.loop
    nodes: set[Node] = {loop.initial}
    for number, row in enumerate(rows):
        letter = tuple(
            {"near": row.near, "stopped": row.stopped}[a] for a in loop.environment.atoms
        )
        nodes = {
            after
            for node in nodes
            for tick, after in loop.steps(node)
            if tick.letter == letter
            and tick.requested == row.request
            and after.losses == row.losses
            and _same(after.wheels, row)
        }
        assert nodes, (number, row)


def _same(wheels: ActuationState, row: Row) -> bool:
    fields = tuple(any(v) if isinstance(v, tuple) else v for v in row.fields)
    return wheels.interceptor == fields and (wheels.still < 0) == row.moving


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "channel"),
    [
        (
            interceptor_options(hold=2, stop_timeout=6),
            ActuationAssumptions(2, latency=2, lost=1, braking=2),
        ),
        (interceptor_options(), ActuationAssumptions(1, latency=2, lost=2, braking=1)),
        (
            interceptor_options(command_timeout=2),
            ActuationAssumptions(2, latency=1, braking=3, punctual=True),
        ),
        (LATCH, ActuationAssumptions(1, edge=True)),
        (
            interceptor_options(hold=1),
            ActuationAssumptions(3, latency=0, lost=1, edge=True, braking=1),
        ),
        (
            interceptor_options(stop_timeout=5),
            ActuationAssumptions(1, latency=2, lost=1, edge=True, heartbeat=3),
        ),
        (
            interceptor_options(hold=2),
            ActuationAssumptions(2, latency=3, lost=2, edge=True, braking=1, heartbeat=2),
        ),
    ],
)
def test_every_simulated_tick_is_a_step_of_the_model(
    settings: Options, channel: ActuationAssumptions
) -> None:
    known = case(WITHIN.format(30), settings, channel)
    for seed in range(6) if FULL else (known.channel.cells % 2,):
        simulation = Simulation(known, seed)
        follows(known, [simulation.tick() for _ in range(60)])


def test_the_simulation_does_something() -> None:
    known = case(
        WITHIN.format(30),
        interceptor_options(hold=2),
        ActuationAssumptions(2, latency=2, lost=1, braking=2),
    )
    simulation = Simulation(known, 1)
    rows = [simulation.tick() for _ in range(200)]
    for column in ("near", "stopped", "request", "moving"):
        assert {getattr(row, column) for row in rows} == {False, True}
    assert {row.losses for row in rows} == {0, 1}


def test_a_run_says_what_is_heard_in_its_order() -> None:
    loop = Parts.of(
        case(WITHIN.format(2), interceptor_options(hold=1), ActuationAssumptions(1))
    ).loop
    tick, after = next(
        (tick, after)
        for tick, after in loop.steps(loop.initial)
        if after.wheels.still < 0 and tick.letter == (False, True)
    )
    assert loop.word(loop.initial, tick, after) == (Event.RELEASE, Event.MOVE, Event.RING, None)


def test_an_environment_chooses_no_comparisons_that_contradict_each_other() -> None:
    never = ((("(x < 2)", True), ("(x > 3)", True)),)
    free = Environment(("stopped", "(x < 2)", "(x > 3)"), "stopped")
    bound = Environment(free.atoms, free.stands, never)
    for stands in (False, True):
        assert {*free.letters(stands)} - {*bound.letters(stands)} == {(stands, True, True)}
    always = ((("stopped", True),),)  # were it never to stand, the loop would end there
    assert Environment(free.atoms, "stopped", always).letters(True) == free.letters(True)
