import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from compiler.project.folder import load
from fretc.campaigns.campaign import intercepted
from fretc.campaigns.experiment import folder, plan, project, safety_function
from fretish.diagnostics.diagnostic import has_errors
from monitors.interceptor import Velocity as Twist
from simulation.nodes import messages
from simulation.nodes.safety import TooClose
from simulation.world.lidar import Lidar
from simulation.world.motion import BodyVelocity, Pose
from simulation.world.scenario import Interceptor

LIDAR = Lidar(beams=8)
MS = 1_000_000
INF, NAN = math.inf, math.nan


@dataclass
class Scan:
    """As rosbags decodes it."""

    ranges: NDArray[np.float32]
    range_min: float = LIDAR.range_min
    range_max: float = LIDAR.range_max
    angle_min: float = -math.pi
    angle_increment: float = math.pi / 4
    header: None = field(default=None)


def scan(*ranges: float) -> Scan:
    return Scan(np.array(ranges, np.float32))


def odometry(forward: float) -> object:
    return messages.odometry(0, "odom", Pose(0.0, 0.0), BodyVelocity(forward, 0.0))


FREE = scan(*[INF] * 8)


def test_the_requirements_of_the_mission_are_read_without_errors() -> None:
    read = project()
    assert not has_errors(read.diagnostics)
    assert sorted(int(requirement.id[1:]) for requirement in read.formalized) == list(range(1, 16))
    assert all(entry.parents for entry in read.requirements)


def test_they_use_at_least_six_templates() -> None:
    templates = set()
    for requirement in project().formalized:
        sentence = requirement.sentence
        scope = sentence.scope.kind if sentence.scope else None
        condition = sentence.condition and sentence.condition.kind
        templates.add((scope, condition, type(sentence.timing)))
    assert len(templates) >= 6


def test_of_r1_the_bindings_are_those_of_the_paper() -> None:
    paper = load([str(folder().parent / "r1.fret")]).declarations
    mission = project().declarations
    assert paper is not None
    assert mission is not None
    assert {k: mission.signals[k] for k in paper.signals} == paper.signals
    assert {k: mission.propositions[k] for k in paper.propositions} == paper.propositions
    assert mission.clock == paper.clock


def test_the_plan_audits_all_of_them() -> None:
    assert len(plan().claims) == 15


@pytest.mark.parametrize(
    ("message", "stop"),
    [
        (FREE, False),
        (scan(*[NAN] * 8), True),
        (scan(), True),
        (scan(NAN, *[INF] * 7), False),
        (scan(NAN, INF, INF, INF, 0.35, INF, INF, INF), True),
        (scan(INF, INF, INF, INF, 0.36, INF, INF, INF), False),
        (scan(-INF, *[INF] * 7), True),
        (scan(*[0.0] * 8), True),
    ],
    ids=["free", "NaN", "empty", "one NaN", "NaN, 4.4 cm", "5.4 cm", "too near", "zeros"],
)
def test_the_safety_function_answers_a_scan(message: Scan, stop: bool) -> None:
    function = safety_function()
    function.hear("/odom", odometry(0.1), 0)
    function.hear("/scan", message, MS)
    assert function.step(MS) is stop


def test_before_the_first_scan_and_after_too_long_a_silence_it_demands_a_stop() -> None:
    function = safety_function()
    assert function.step(0)
    function.hear("/scan", FREE, 100 * MS)
    function.hear("/odom", odometry(0.0), 100 * MS)
    silent = safety_function()
    silent.hear("/scan", FREE, 0)
    assert [silent.step(at * MS) for at in (0, 100, 200, 300, 400)] == [False] * 4 + [True]


def test_a_demand_is_open_until_the_robot_has_stood_for_200_ms() -> None:
    function = safety_function()
    near = scan(INF, INF, INF, INF, 0.33, INF, INF, INF)
    demands = []
    for tick in range(12):
        now = tick * 100 * MS
        speed = 0.3 if tick < 4 else 0.0
        for at in range(now - 80 * MS, now + 1, 20 * MS):
            function.hear("/odom", odometry(speed), max(0, at))
        function.hear("/scan", near if tick == 2 else FREE, now)
        demands.append(function.step(now))
    assert demands == [False, False, True, True, True, True] + [False] * 6


def test_the_threshold_can_be_another() -> None:
    message = scan(INF, INF, INF, INF, 1.0, INF, INF, INF)  # 69 cm from the outline
    for threshold, stop in ((0.05, False), (0.69, False), (0.70, True), (0.9, True)):
        function = safety_function(threshold)
        function.hear("/odom", odometry(0.1), 0)
        function.hear("/scan", message, 0)
        assert function.step(0) is stop


ranges = st.lists(
    st.one_of(st.floats(0.125, 3.0, width=32), st.sampled_from([INF, -INF, NAN, 13.0])),
    min_size=8,
    max_size=8,
)


@pytest.mark.slow
@given(ranges)
@example([NAN] * 7 + [13.0])  # beyond the range of the sensor, and no +inf
def test_while_nothing_is_open_it_decides_as_the_threshold_by_hand(values: list[float]) -> None:
    compiled, by_hand = safety_function(), TooClose(LIDAR)
    for decision in (compiled, by_hand):
        decision.hear("/odom", odometry(0.1), 0)
        decision.hear("/scan", scan(*values), 0)
    assert compiled.step(0) is by_hand.step(0)


FAST = Twist(0.4, wz=0.1)
STILL = Twist()
GO, STOP = messages.boolean(False), messages.boolean(True)


def commands(options: Interceptor, *arrivals: Any) -> list[Twist]:
    """What the emitted interceptor publishes; a number stands for that many ticks."""
    out: list[Twist] = []
    gate: Any = intercepted(options)(lambda six: out.append(Twist(*six)))
    for one in arrivals:
        if isinstance(one, int):
            for _ in range(one):
                gate.ring()
        elif isinstance(one, Twist):
            gate.hear_command(messages.twist(BodyVelocity(one.vx, one.wz)))
        else:
            gate.hear_stop(one)
    return out


def test_the_simulated_robot_has_the_interceptor_of_the_bindings() -> None:
    declared = project().declarations
    assert declared is not None
    assert declared.interceptor is not None
    normal, node = Interceptor(), declared.interceptor
    assert (node.stop, node.command, node.output, node.scan) == (
        "/gwendolen_control",
        "/cmd_vel",
        "/cmd_vel_filtered",
        None,
    )
    seconds = (normal.period, normal.hold, normal.safety_timeout, normal.command_timeout)
    durations = (node.period, node.hold, node.stop_timeout, node.command_timeout)
    assert tuple(round(one * 10**9) for one in seconds) == durations
    assert (normal.at_once, normal.latching) == (node.form == "timer", node.latching)


def test_an_interceptor_of_a_scenario_is_the_emitted_one_with_its_options() -> None:
    assert commands(Interceptor(), FAST, GO, FAST, 1) == [STILL, FAST, FAST]
    assert commands(Interceptor(), GO, FAST, STOP, GO, 5) == [FAST] + [STILL] * 5 + [FAST]
    assert commands(Interceptor(hold=0.05), GO, FAST, STOP, GO, 2) == [FAST, STILL, STILL, FAST]
    assert commands(Interceptor(), GO, FAST, 10) == [FAST] * 10 + [STILL]
    patient = Interceptor(command_timeout=0, safety_timeout=0.1)
    assert commands(patient, GO, FAST, 2) == [FAST, FAST, STILL]
    latching = Interceptor(hold=0, latching=True)
    assert commands(latching, GO, FAST, STOP, GO, FAST) == [FAST, STILL, STILL]


def test_the_papers_interceptor_says_zero_only_when_a_command_comes() -> None:
    paper = Interceptor(at_once=False, period=0, hold=0, command_timeout=0, safety_timeout=0)
    assert commands(paper, FAST, STOP, 3, FAST, GO, FAST) == [FAST, STILL, FAST]
