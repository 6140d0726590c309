"""The reports of agents in a log: what is read, when it counts, and what is no report."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.agents.reports import LONGEST, _parsed, _trace
from fretc.logs.agents.word_signals import word_signals
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import AgentTrace, MentalState, Recording
from tests.effort import examples
from tests.fretc.logs.logs import MS, S, Sent, declare, payload, write

STRING, POINT = "std_msgs/msg/String", "geometry_msgs/msg/Point"
BINDINGS = """
[clock]
tick = "100 ms"
time = "{}"
[signal.z]
path = "/at.z"
unit = "m"
[proposition.near]
expr = "z < 1 m"
[agent]
trace = "/agent/trace"
"""
START = 1000 * S


def report(agent: str, ns: int, *beliefs: str, **more: Any) -> dict[str, Any]:
    return {"time": ns, "agent": agent, "beliefs": beliefs, "goals": [], "action": None, **more}


def sent(*reports: Any, encoding: str = "cdr") -> list[Sent]:
    """Reports 10 ms apart, published 1 ms earlier, among the messages of a robot."""
    kind = STRING if encoding == "cdr" else "std_msgs/String"
    point = POINT if encoding == "cdr" else "geometry_msgs/Point"
    found = []
    for number, each in enumerate(reports):
        time, text = START + number * 10 * MS, each if isinstance(each, str) else json.dumps(each)
        data = payload(kind, encoding, data=text)
        found.append(Sent("/agent/trace", kind, data, time, time - MS, encoding=encoding))
        at = payload(point, encoding, x=0.0, y=0.0, z=1.0)
        found.append(Sent("/at", point, at, time, encoding=encoding))
    return found


def recording(path: Path, messages: list[Sent], clock: str = "log_time", **more: Any) -> Recording:
    found = read(str(write(path, messages)), declare(BINDINGS.format(clock)), ["z"], **more)
    assert isinstance(found, Recording), found
    return found


def plain(trace: AgentTrace) -> tuple[Any, ...]:
    return trace.times.tolist(), trace.states, trace.actions


@pytest.mark.parametrize("integrity", [Integrity.INDEX, Integrity.HASH, Integrity.FULL])
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_the_trace_of_each_agent_is_read(
    tmp_path: Path, integrity: Integrity, encoding: str
) -> None:
    messages = sent(
        report("sw", 1, "near"),
        report("arm", 2, goals=["held"]),
        report("sw", 3, "near", action="halt"),
        report("sw", 4, "stopped", "near"),
        encoding=encoding,
    )
    found = recording(tmp_path / "a.mcap", messages, integrity=integrity)
    times = [START + n * 10 * MS for n in range(4)]
    assert {name: plain(trace) for name, trace in found.agents.items()} == {
        "arm": ([times[1]], (MentalState(times[1], (), ("held",)),), ()),
        "sw": (
            [times[0], times[2], times[3]],
            (
                MentalState(times[0], ("near",), ()),
                MentalState(times[3], ("near", "stopped"), ()),
            ),
            ((times[2], "halt"),),
        ),
    }
    assert found.findings == ()


@pytest.mark.parametrize(
    ("clock", "time"), [("log_time", START), ("publish_time", START - MS), ("header.stamp", 17)]
)
def test_a_report_has_the_time_of_the_clock(tmp_path: Path, clock: str, time: int) -> None:
    found = recording(tmp_path / "a.mcap", sent(report("sw", 17, "near")), clock)
    assert found.agents["sw"].times.tolist() == [time]


NO_REPORTS = (
    "no JSON",
    "[1]",
    "{}",
    "9" * 5000,
    "[" * 5000,
    {**report("sw", 1), "beliefs": "near"},
    {**report("sw", 1), "beliefs": ["x"] * 101},
    {**report("sw", 1), "goals": [3]},
    {**report("sw", 1), "action": ["halt"]},
    {**report("sw", 1), "agent": "s\x1bw"},
    {**report("sw", 1), "agent": ""},
    {**report("sw", 1), "time": "17"},
    {**report("sw", 1), "more": "x" * LONGEST},
)


@pytest.mark.parametrize("number", range(len(NO_REPORTS)))
def test_what_is_no_report_is_counted(tmp_path: Path, number: int) -> None:
    messages = sent(NO_REPORTS[number], report("sw", 1, "near"))
    found = recording(tmp_path / "a.mcap", messages)
    assert [state.beliefs for state in found.agents["sw"].states] == [("near",)]
    (finding,) = found.findings
    assert (finding.code.number, finding.is_error) == ("F916", False)
    assert finding.message == "1 of 2 messages of `/agent/trace` are no report of an agent"


def test_a_topic_of_another_type_has_no_reports(tmp_path: Path) -> None:
    messages = [
        Sent("/agent/trace", POINT, payload(POINT, x=0.0, y=0.0, z=0.0), START),
        Sent("/at", POINT, payload(POINT, x=0.0, y=0.0, z=0.0), START),
    ]
    found = recording(tmp_path / "a.mcap", messages)
    assert found.agents == {}
    assert [finding.code.number for finding in found.findings] == ["F916"]


def test_nothing_else_of_the_recording_depends_on_reports(tmp_path: Path) -> None:
    """Ticks begin with the first message of a signal, whatever an agent has reported before."""
    early = Sent("/agent/trace", STRING, payload(STRING, data="{}"), START - S)
    path = write(tmp_path / "a.mcap", [early, *sent(report("sw", 1, "near"))])
    with_trace = declare(BINDINGS.format("log_time"))
    without = declare(BINDINGS.format("log_time").partition("[agent]")[0])
    one, other = (read(str(path), bindings, ["z"]) for bindings in (with_trace, without))
    assert isinstance(one, Recording)
    assert isinstance(other, Recording)
    assert (one.start_ns, one.end_ns) == (other.start_ns, other.end_ns) == (START, START)
    assert one.samples["z"].times.tolist() == other.samples["z"].times.tolist()
    assert other.agents == {}


NAMES = st.lists(st.sampled_from(["near", "stopped", "far"]), max_size=3)


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 50), NAMES), max_size=8))
def test_words_say_what_was_believed_at_each_time(reports: list[tuple[int, list[str]]]) -> None:
    parsed = [_parsed({**report("sw", ns), "beliefs": names}, ns) for ns, names in reports]
    trace = _trace([each for each in parsed if each is not None])
    signals = word_signals({"sw": trace})
    for ns in range(52):
        before = [names for at, names in sorted(reports, key=lambda each: each[0]) if at <= ns]
        if not before:
            continue
        samples = signals["belief of sw"]
        index = int((samples.times <= ns).sum()) - 1
        word = samples.words[int(samples.values[index])]
        assert word == (", ".join(sorted({*before[-1]})) or "nothing")
    assert "goal of sw" not in signals
    assert "last action of sw" not in signals
