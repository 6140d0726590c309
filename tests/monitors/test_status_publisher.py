"""What a node publishes: a stop at once, all of it with each heartbeat, and a stop at the end."""

from __future__ import annotations

import json
from typing import Any

import pytest

from monitors.status_publisher import Channels, StatusPublisher
from monitors.stop_supervisor import Status


class Wanted:
    """Stands for a supervisor: it says what the test wants."""

    def __init__(self) -> None:
        self.stops, self.ticks, self.failure = False, 0, ""
        self.came: list[tuple[Any, ...]] = []

    def arrive(self, *what: Any) -> None:
        if self.failure:
            raise RuntimeError(self.failure)
        self.came.append(what)

    def pass_to(self, now: int) -> None:
        self.came.append((now,))

    def stop(self, steady: float) -> bool:
        return self.stops

    def news(self) -> list[dict[str, Any]]:
        return [{"tick": self.ticks}]

    def statuses(self, steady: float) -> list[Status]:
        return [Status(0, "a", "b", ())]


class Said:
    """What was published, and the clocks."""

    def __init__(self) -> None:
        self.stops: list[bool] = []
        self.lines: list[str] = []
        self.reports, self.now, self.steady = 0, 1, 0.0

    def report(self, statuses: object) -> None:
        self.reports += 1

    def publisher(self, supervisor: Wanted, heartbeat: float = 0.1) -> StatusPublisher:
        channels = Channels(self.stops.append, self.lines.append, self.report, lambda: self.now)
        return StatusPublisher(supervisor, channels, heartbeat, lambda: self.steady)  # type: ignore[arg-type]


def test_a_stop_is_said_at_once_and_again_with_each_heartbeat() -> None:
    supervisor, said = Wanted(), Said()
    publisher = said.publisher(supervisor)
    publisher.on_message("/x", 1)
    publisher.on_message("/x", 2)
    assert said.stops == [False]
    supervisor.stops = True
    publisher.on_message("/x", 3)
    publisher.on_message("/x", 4)
    assert said.stops == [False, True]
    publisher.on_heartbeat()
    assert said.stops == [False, True, True]
    publisher.close()
    publisher.on_heartbeat()
    publisher.close()
    assert said.stops == [False, True, True, True]


def test_it_stops_at_the_end_whatever_it_said() -> None:
    said = Said()
    publisher = said.publisher(Wanted())
    publisher.on_heartbeat()
    publisher.close()
    assert said.stops == [False, True]


def test_verdicts_come_with_each_tick_and_each_heartbeat() -> None:
    supervisor, said = Wanted(), Said()
    publisher = said.publisher(supervisor)
    publisher.on_message("/x", 1)
    assert said.lines == []
    supervisor.ticks = 1
    publisher.on_message("/x", 1)
    publisher.on_message("/x", 1)
    publisher.on_heartbeat()
    assert list(map(json.loads, said.lines)) == [{"tick": 1}] * 2


def test_nothing_is_taken_before_the_clock_has_begun() -> None:
    supervisor, said = Wanted(), Said()
    said.now = 0
    publisher = said.publisher(supervisor)
    publisher.on_message("/x", 1)
    publisher.on_heartbeat()
    assert supervisor.came == []
    said.now = 7
    publisher.on_message("/x", 1, ("x",))
    publisher.on_heartbeat()
    assert supervisor.came == [("/x", 1, 7, 0.0, ("x",)), (7,)]


def test_diagnostics_come_now_and_then() -> None:
    said = Said()
    publisher = said.publisher(Wanted())
    for said.steady in (0.0, 0.1, 0.4, 0.5, 0.6, 1.1):
        publisher.on_heartbeat()
    assert said.reports == 3


def test_a_failure_stops_the_robot_and_ends_the_node() -> None:
    supervisor, said = Wanted(), Said()
    publisher = said.publisher(supervisor)
    publisher.on_message("/x", 1)
    supervisor.failure = "out of order"
    publisher.on_message("/x", 1)
    supervisor.failure = ""
    publisher.on_message("/x", 1)
    assert said.stops == [False, True]
    with pytest.raises(RuntimeError, match="out of order"):
        publisher.on_heartbeat()
    assert said.stops == [False, True, True]


@pytest.mark.parametrize("heartbeat", [0.0, -1.0, 11.0, float("nan"), "0.1", True])
def test_a_heartbeat_that_is_no_time_is_refused(heartbeat: Any) -> None:
    with pytest.raises(ValueError, match=r"heartbeat is from 0.001 to 10 s, not"):
        Said().publisher(Wanted(), heartbeat)
