"""A simulated mission whose safety function is the agent in MCAPL, and what becomes of faults."""

import json
import os
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from fretc.campaigns.agent import AgentLink, agent
from fretc.campaigns.campaign import intercepted
from fretc.campaigns.experiment import safety_function
from fretish.system.processes import kill_all
from simulation.mission import EPOCH, Mission, record
from simulation.recording import TOPICS
from simulation.world.scenario import Scenario, load
from tests.command import Fretc
from tests.effort import full_only
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


@needs("java", "javac")
@pytest.mark.slow
def test_the_agent_stops_the_robot_when_the_monitor_does(
    scenario: Scenario, tmp_path: Path
) -> None:
    """R1's monitor may demand a second stop: until the robot stands, which the agent believes."""
    with agent(scenario.safety.threshold, TYPES) as link:
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
    with agent(scenario.safety.threshold, TYPES) as link:
        run = mission(tmp_path / "agent.mcap", scenario, None, link)
    monitored = mission(tmp_path / "monitor.mcap", scenario, None, safety_function(0.05))
    assert (run.goals_reached, run.contacts) == (monitored.goals_reached, monitored.contacts)
    verdicts = [audited(fretc, tmp_path / f"{name}.mcap") for name in ("agent", "monitor")]
    assert verdicts[0] == verdicts[1]
    assert {*verdicts[0].values()} == {"satisfied"}


# Faults ----------------------------------------------------------------------------------------

FAULT = 6.0
"""Simulated seconds; the robot drives then."""
STANDS = 1.2 + 0.1 + 0.4
"""Seconds until the robot stands: silence, two periods of the interceptor, braking."""


class Faulty(AgentLink):
    """An agent to which something happens."""

    def __init__(self, link: AgentLink, fault: Any) -> None:
        self.__dict__ = link.__dict__
        self.fault, self.happened = fault, False

    def step(self, time: int) -> bool:
        if not self.happened and time - EPOCH >= FAULT * 1e9:
            self.happened = True
            self.fault(self)
        return super().step(time)


def killed(link: AgentLink) -> None:
    kill_all(link.process)
    link.process.wait()


def frozen(link: AgentLink) -> None:
    os.killpg(link.process.pid, signal.SIGSTOP)


def unreachable(link: AgentLink) -> None:
    assert link._endpoint is not None
    link._endpoint.close()


def moved(path: Path) -> Sequence[float]:
    """The times at which the robot moved."""
    return [
        time
        for _, time, odom in messages(path, "/ground_truth")
        if abs(odom.twist.twist.linear.x) > 0.01 or abs(odom.twist.twist.angular.z) > 0.01
    ]


@needs("java", "javac")
@pytest.mark.slow
@pytest.mark.parametrize("fault", [killed, frozen, unreachable])
def test_without_the_agent_the_robot_stands_within_the_bound(
    scenario: Scenario, tmp_path: Path, fault: Any
) -> None:
    path = tmp_path / "fault.mcap"
    with agent(scenario.safety.threshold, TYPES) as link:
        run = mission(path, scenario, 12, Faulty(link, fault))
        assert not link.speaks
        if fault is frozen:
            os.killpg(link.process.pid, signal.SIGCONT)
    times = moved(path)
    assert any(FAULT - 0.5 < time < FAULT for time in times)
    assert max(times) < FAULT + STANDS
    assert run.contacts == 0
    said = [time for _, time, _ in messages(path, "/gwendolen_control")]
    assert max(said) <= FAULT + 0.1


@needs("java", "javac")
@pytest.mark.slow
@full_only("four missions with an agent take two minutes")
@pytest.mark.parametrize("name", ["scan-lost", "scan-swapped", "scan-delayed", "lidar-silent"])
def test_verdicts_with_an_agent_are_those_that_the_scenario_states(
    monkeypatch: pytest.MonkeyPatch, fretc: Fretc, tmp_path: Path, name: str
) -> None:
    monkeypatch.setenv("AJPF_HOME", mcapl())
    scenario = load(name)
    with agent(scenario.safety.threshold, TYPES) as link:
        mission(tmp_path / "a.mcap", scenario, None, link)
    verdicts = audited(fretc, tmp_path / "a.mcap")
    stated = scenario.expect.verdicts
    assert {id: verdicts[id] for id in stated} == stated
