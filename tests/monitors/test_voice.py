"""What a node publishes: a stop at once, all of it with each heartbeat, and a stop at the end."""

from __future__ import annotations

import json
from typing import Any

import pytest

from monitors.guard import Status
from monitors.voice import Channels, Voice


class Wanted:
    """Stands for a guard: it says what the test wants."""

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

    def voice(self, guard: Wanted, heartbeat: float = 0.1) -> Voice:
        channels = Channels(self.stops.append, self.lines.append, self.report, lambda: self.now)
        return Voice(guard, channels, heartbeat, lambda: self.steady)  # type: ignore[arg-type]


def test_a_stop_is_said_at_once_and_again_with_each_heartbeat() -> None:
    guard, said = Wanted(), Said()
    voice = said.voice(guard)
    voice.hear("/x", 1)
    voice.hear("/x", 2)
    assert said.stops == [False]
    guard.stops = True
    voice.hear("/x", 3)
    voice.hear("/x", 4)
    assert said.stops == [False, True]
    voice.beat()
    assert said.stops == [False, True, True]
    voice.close()
    voice.beat()
    voice.close()
    assert said.stops == [False, True, True, True]


def test_it_stops_at_the_end_whatever_it_said() -> None:
    said = Said()
    voice = said.voice(Wanted())
    voice.beat()
    voice.close()
    assert said.stops == [False, True]


def test_verdicts_come_with_each_tick_and_each_heartbeat() -> None:
    guard, said = Wanted(), Said()
    voice = said.voice(guard)
    voice.hear("/x", 1)
    assert said.lines == []
    guard.ticks = 1
    voice.hear("/x", 1)
    voice.hear("/x", 1)
    voice.beat()
    assert list(map(json.loads, said.lines)) == [{"tick": 1}] * 2


def test_nothing_is_taken_before_the_clock_has_begun() -> None:
    guard, said = Wanted(), Said()
    said.now = 0
    voice = said.voice(guard)
    voice.hear("/x", 1)
    voice.beat()
    assert guard.came == []
    said.now = 7
    voice.hear("/x", 1, ("x",))
    voice.beat()
    assert guard.came == [("/x", 1, 7, 0.0, ("x",)), (7,)]


def test_diagnostics_come_now_and_then() -> None:
    said = Said()
    voice = said.voice(Wanted())
    for said.steady in (0.0, 0.1, 0.4, 0.5, 0.6, 1.1):
        voice.beat()
    assert said.reports == 3


def test_a_failure_stops_the_robot_and_ends_the_node() -> None:
    guard, said = Wanted(), Said()
    voice = said.voice(guard)
    voice.hear("/x", 1)
    guard.failure = "out of order"
    voice.hear("/x", 1)
    guard.failure = ""
    voice.hear("/x", 1)
    assert said.stops == [False, True]
    with pytest.raises(RuntimeError, match="out of order"):
        voice.beat()
    assert said.stops == [False, True, True]


@pytest.mark.parametrize("heartbeat", [0.0, -1.0, 11.0, float("nan"), "0.1", True])
def test_a_heartbeat_that_is_no_time_is_refused(heartbeat: Any) -> None:
    with pytest.raises(ValueError, match=r"heartbeat is from 0.001 to 10 s, not"):
        Said().voice(Wanted(), heartbeat)
