"""The reports of agents on the topic of their trace: one JSON text in a `std_msgs/String` each.

Such as `{"time": 17, "agent": "sw", "beliefs": ["near"], "goals": [], "action": "halt"}`; `time`
is in nanoseconds, `action` is null without one, and `"failed": true` says that it has failed. A
report in another form is counted, and left out. The time of a report is that of its message; where
the clock goes by stamps, it is `time`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import LATEST
from fretc.logs.messages.decoding import Decode, decoder
from fretc.logs.signals.samples import AgentTrace, MentalState
from fretc.logs.signals.signals import field_of
from fretish.bindings.declarations import Path
from fretish.classes.frozen import dataclass
from fretish.clock import Clock, TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

LONGEST = 2**16
"""The most bytes of a report."""
MOST = 1_000_000
"""The most reports of a log; later ones are left out."""
_DATA = Path("", ("data",))
_MOST_AGENTS, _MOST_NAMES, _LONGEST_NAME = 16, 100, 100


@dataclass(frozen=True, slots=True)
class _Report:
    agent: str
    state: MentalState
    action: str | None


class AgentReports:
    """A collector of the reports in a log."""

    def __init__(self, topic: str | None, clock: Clock) -> None:
        """`topic`: of the trace; None: nothing is collected."""
        self.topic = topic
        self.unreadable = 0
        """Messages of the topic that are no report."""
        self._clock = clock
        self._reports: list[_Report] = []
        self._decoders: dict[int, Decode | None] = {}

    def take(
        self, stream: ChannelDefinition, log_time: int, publish_time: int, payload: bytes
    ) -> None:
        """One message of the topic; times are nanoseconds."""
        id = stream.channel.id
        if id not in self._decoders:
            decode = decoder(stream)
            self._decoders[id] = None if isinstance(decode, str) else decode
        report = self._report(self._decoders[id], log_time, publish_time, payload)
        if report is None or len(self._reports) >= MOST:
            self.unreadable += 1
        else:
            self._reports.append(report)

    def _report(
        self, decode: Decode | None, log_time: int, publish_time: int, payload: bytes
    ) -> _Report | None:
        if decode is None or len(payload) > LONGEST:
            return None
        try:
            data = field_of(_DATA, decode(payload))
            read = json.loads(data) if isinstance(data, str) else None
        except Exception:  # the decoder trusts each byte, and each may be wrong
            return None
        if not isinstance(read, dict) or not isinstance(read.get("time"), int):
            return None
        match self._clock.time:
            case TimeSource.LOG_TIME:
                time = log_time
            case TimeSource.PUBLISH_TIME:
                time = publish_time
            case TimeSource.HEADER_STAMP:
                time = read["time"]
        return _parsed(read, time) if 0 <= time < LATEST else None

    def traces(self) -> Mapping[str, AgentTrace]:
        """Name of each agent → its trace; of the first 16 agents."""
        by_agent: dict[str, list[_Report]] = {}
        for report in self._reports:
            if report.agent in by_agent or len(by_agent) < _MOST_AGENTS:
                by_agent.setdefault(report.agent, []).append(report)
        return {name: _trace(by_agent[name]) for name in sorted(by_agent)}

    def findings(self, log: Span) -> Iterator[Diagnostic]:
        """F916 if messages of the topic are no report."""
        if self.unreadable:
            count = self.unreadable + len(self._reports)
            yield diagnostic(
                "no_report", log, unreadable=self.unreadable, count=count, topic=self.topic
            )


def _parsed(read: Mapping[str, Any], time: int) -> _Report | None:
    beliefs, goals = _names(read.get("beliefs")), _names(read.get("goals"))
    agent, action = read.get("agent"), read.get("action")
    if beliefs is None or goals is None or not _is_name(agent):
        return None
    if action is not None and not _is_name(action):
        return None
    done = f"{action} (failed)" if action and read.get("failed") is True else action
    return _Report(str(agent), MentalState(time, beliefs, goals), done)


def _names(value: object) -> tuple[str, ...] | None:
    if not isinstance(value, list) or len(value) > _MOST_NAMES or not all(map(_is_name, value)):
        return None
    return tuple(sorted({*value}))


def _is_name(value: object) -> bool:
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_NAME and value.isprintable()


def _trace(reports: list[_Report]) -> AgentTrace:
    ordered = sorted(reports, key=lambda report: report.state.ns)  # stable: equal times stay
    states: list[MentalState] = []
    for report in ordered:
        new = report.state
        if not states or (states[-1].beliefs, states[-1].goals) != (new.beliefs, new.goals):
            states.append(new)
    return AgentTrace(
        np.array([report.state.ns for report in ordered], np.int64),
        tuple(states),
        tuple((report.state.ns, report.action) for report in ordered if report.action is not None),
    )
