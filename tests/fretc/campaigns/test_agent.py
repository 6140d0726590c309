"""A simulated mission whose safety function is the agent in MCAPL, and what becomes of faults."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from fretc.campaigns.agent import AgentLink, agent
from fretc.campaigns.campaign import intercepted
from fretc.campaigns.experiment import safety_function
from simulation.mission import EPOCH, Mission, record
from simulation.recording import TOPICS
from simulation.world.scenario import Scenario, load, names
from tests.command import Fretc
from tests.effort import FULL, full_only
from tests.programs import mcapl, needs

TYPES = {topic.name: topic.type for topic in TOPICS}


@pytest.fixture
def scenario(monkeypatch: pytest.MonkeyPatch) -> Scenario:
    monkeypatch.setenv("AJPF_HOME", mcapl())
    return load("obstacle-moved")


def mission(out: Path, scenario: Scenario, seconds: float | None, decision: Any) -> Mission:
    interceptor = intercepted(scenario.interceptor)
    if isinstance(decision, AgentLink):
        return record(out, scenario, interceptor, 7, max_seconds=seconds, agent=decision)
    return record(out, scenario, interceptor, 7, decision, max_seconds=seconds)


def messages(path: Path, *topics: str) -> list[tuple[str, float, Any]]:
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [
            (channel.topic, (message.log_time - EPOCH) / 1e9, decoded)
            for _, channel, message, decoded in reader.iter_decoded_messages(topics=[*topics])
        ]


def audited(fretc: Fretc, log: Path) -> dict[str, str]:
    """The verdict of each requirement of a mission."""
    folder = str(Path(__file__).parents[3] / "requirements/mission")
    evidence = log.with_suffix(".json")
    fretc("audit", str(log), "--requirements", folder, "-o", str(evidence))
    results = json.loads(evidence.read_text(encoding="utf-8"))["results"]
    return {each["requirement"]: each["verdict"] for each in results}


@pytest.mark.slow
def test_without_mcapl_no_mission_begins(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AJPF_HOME", raising=False)
    run = fretc("simulate", "--agent", "-o", "a.mcap")
    assert run.status == 2
    assert run.err.startswith(
        "F915 the agent cannot be started: set AJPF_HOME to the folder of MCAPL\n"
    )
    assert not Path("a.mcap").exists()


def test_an_agent_takes_part_in_no_campaign(fretc: Fretc) -> None:
    run = fretc("simulate", "--agent", "--campaign", "2")
    assert run.status == 2
    assert "--campaign cannot be combined with --png, --gif, --agent" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("more", [("-o", "a.mcap"), ("--campaign", "1")])
def test_a_fault_of_the_agent_needs_an_agent(fretc: Fretc, more: tuple[str, ...]) -> None:
    run = fretc("simulate", "agent-killed", *more)
    assert run.status == 2
    assert "the scenario agent-killed needs --agent" in run.err
    assert not Path("a.mcap").exists()


@needs("java", "javac")
@pytest.mark.slow
def test_the_agent_stops_the_robot_when_the_monitor_does(
    scenario: Scenario, tmp_path: Path
) -> None:
    """R1's monitor may demand a second stop: until the robot stands, which the agent believes."""
    with agent(scenario, TYPES) as link:
        run = mission(tmp_path / "agent.mcap", scenario, 20, link)
        assert link.speaks
    monitored = mission(tmp_path / "m.mcap", scenario, 20, safety_function(0.05))
    assert run.requests[:3] == monitored.requests[:3]
    assert run.stops[0] == monitored.stops[0]
    assert run.contacts == 0
    told = messages(tmp_path / "agent.mcap", "/agent/trace")
    records = [(time, json.loads(decoded.data)) for _, time, decoded in told]
    ((time, stop),) = [(t, r) for t, r in records if r["action"] == "stop_moving"]
    assert stop["beliefs"] == ["too_close"]
    assert (time, True) == run.requests[1]


@needs("java", "javac")
@pytest.mark.slow
@full_only("a whole mission takes forty seconds")
def test_a_whole_mission_ends_as_with_the_monitor(
    scenario: Scenario, fretc: Fretc, tmp_path: Path
) -> None:
    with agent(scenario, TYPES) as link:
        run = mission(tmp_path / "agent.mcap", scenario, None, link)
    monitored = mission(tmp_path / "monitor.mcap", scenario, None, safety_function(0.05))
    assert (run.goals_reached, run.contacts) == (monitored.goals_reached, monitored.contacts)
    verdicts = [audited(fretc, tmp_path / f"{name}.mcap") for name in ("agent", "monitor")]
    assert verdicts[0] == verdicts[1]
    assert {*verdicts[0].values()} == {"satisfied"}


# Faults ----------------------------------------------------------------------------------------

STANDS = 1.2 + 0.1 + 0.4
"""Seconds until the robot stands: silence, two periods of the interceptor, braking."""
FAULTS = tuple(name for name in names() if load(name).agent is not None)
SILENT = ("killed", "frozen", "out-of-memory", "unreachable")
HALTED = ("clock-ahead",)
GOES_ON = ("paused", "reconnected", "scans-dropped", "scans-delayed")
HARMLESS = ("scans-duplicated", "scans-reordered")
SOME = ("agent-killed", "agent-scans-delayed")
"""Those that are tried without the full profile."""


def faulty(monkeypatch: pytest.MonkeyPatch, out: Path, name: str) -> tuple[Mission, AgentLink]:
    monkeypatch.setenv("AJPF_HOME", mcapl())
    scenario = load(name)
    with agent(scenario, TYPES) as link:
        return mission(out, scenario, None, link), link


def moved(path: Path) -> Sequence[float]:
    """The times at which the robot moved."""
    return [
        time
        for _, time, odom in messages(path, "/ground_truth")
        if abs(odom.twist.twist.linear.x) > 0.01 or abs(odom.twist.twist.angular.z) > 0.01
    ]


def test_each_fault_has_its_test() -> None:
    names = {*SILENT, *HALTED, *GOES_ON, *HARMLESS, "clock-behind"}
    assert {f"agent-{name}" for name in names} == {*FAULTS}
    assert len(FAULTS) == 12


@needs("java", "javac")
@pytest.mark.slow
@pytest.mark.parametrize("name", [*FAULTS] if FULL else SOME)
def test_the_robot_stands_within_the_bound_or_the_fault_is_harmless(
    monkeypatch: pytest.MonkeyPatch, fretc: Fretc, tmp_path: Path, name: str
) -> None:
    path, kind = tmp_path / "fault.mcap", name.removeprefix("agent-")
    run, link = faulty(monkeypatch, path, name)
    fault = run.scenario.agent
    assert fault is not None
    begin, end = fault.at, fault.at + fault.seconds
    times = moved(path)
    assert any(begin - 0.5 < time < begin for time in times)
    assert run.contacts == 0
    spoken = [time for _, time, _ in messages(path, "/gwendolen_control")]
    if kind in (*SILENT, *HALTED):
        assert max(times) < begin + STANDS
        assert link.speaks is (kind in HALTED)
    if kind in SILENT:
        assert max(spoken) <= begin + 0.1
    if kind in GOES_ON:
        assert not any(begin + STANDS < time < end for time in times)
    if kind in (*GOES_ON, *HARMLESS, "clock-behind"):
        assert link.speaks
        assert max(times) > run.duration - 10
    if kind in HARMLESS:
        first = min(at for at, is_stop in run.requests if is_stop)
        assert 12 < first < 14, "the obstacle is at 12.7 s"
    if kind == "clock-behind":
        assert any(8.5 < time < 9 for time in times)
        assert not any(9 + STANDS < time < 11 for time in times)
    verdicts = audited(fretc, path)
    stated = run.scenario.expect.verdicts
    assert {id: verdicts[id] for id in stated} == stated


@needs("java", "javac")
@pytest.mark.slow
@full_only("four missions with an agent take two minutes")
@pytest.mark.parametrize("name", ["scan-lost", "scan-swapped", "scan-delayed", "lidar-silent"])
def test_verdicts_with_an_agent_are_those_that_the_scenario_states(
    monkeypatch: pytest.MonkeyPatch, fretc: Fretc, tmp_path: Path, name: str
) -> None:
    monkeypatch.setenv("AJPF_HOME", mcapl())
    scenario = load(name)
    with agent(scenario, TYPES) as link:
        mission(tmp_path / "a.mcap", scenario, None, link)
    verdicts = audited(fretc, tmp_path / "a.mcap")
    stated = scenario.expect.verdicts
    assert {id: verdicts[id] for id in stated} == stated
