"""Windows of recorded runs: on a page they are judged as in the whole run."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

from compiler.targets.python import monitor as emitted
from fretc.logs.signals.traces import WholeTicks
from fretc.play.recorded import SHOWN, RecordedRun
from fretc.play.starts import MOST, RecordedPlace, Start
from monitors.kernel import Column, Monitor
from monitors.loading import load
from tests.effort import FULL
from tests.monitoring import requirement
from tests.strategies import Template, templates

TICKS = 400


def run_of(sentence: str, columns: dict[str, list[bool | None]]) -> RecordedRun:
    count = len(next(iter(columns.values())))
    times = WholeTicks(np.arange(count) * 100_000_000 + 5, 100_000_000)
    made = {
        name: Column(
            sum(1 << t for t, v in enumerate(values) if v),
            sum(1 << t for t, v in enumerate(values) if v is None),
        )
        for name, values in columns.items()
    }
    subject = requirement(sentence)
    return RecordedRun(subject, {name: made[name] for name in subject.watched}, times, "run.mcap")


def signals(machine: Monitor, rows: list[dict[str, Any]]) -> list[tuple[Any, ...]]:
    """Of each tick, by steps."""
    machine.reset()
    found = []
    for row in rows:
        machine.advance([row])
        found.append((*machine.certain.signals(), *machine.possible.signals()))
    return found


def rows_of(start: Start) -> list[dict[str, Any]]:
    return [dict(values) for count, values in start.rows for _ in range(count)]


def place(start: Start) -> int:
    return int(start.about.split(": ticks ")[1].split(" to ")[0])


@pytest.mark.slow
def test_each_tick_of_a_window_is_judged_as_in_the_whole_run() -> None:
    """By steps of the monitor: all signals are the same, but for a trigger at the first tick."""
    choose = random.Random(5)
    seen = 0
    for template in choose.sample([*templates((0, 2))], 60 if FULL else 30):
        columns = noise(template, choose)
        made = run_of(template.sentence, columns)
        machine: Monitor = load("m.py", emitted.text(requirement(template.sentence)))
        names = [*machine.PROPOSITIONS]
        whole = signals(machine, [{n: columns[n][t] for n in names} for t in range(TICKS)])
        for start in made.starts():
            first, rows = place(start), rows_of(start)
            assert rows == [{n: columns[n][first + t] for n in rows[0]} for t in range(len(rows))]
            alone = signals(machine, rows)
            assert alone[1:] == whole[first + 1 : first + len(rows)], template
            begins = "an obligation from before this window starts at its first tick" in start.about
            assert (alone[0] == whole[first]) is not begins, template
            assert any(
                each.violation or each.violation_inevitable for tick in alone for each in tick
            ), template
            seen += 1
        assert len([*made.starts()]) + len([*made.notes()]) >= min(SHOWN, made.violations)
    assert seen > (100 if FULL else 50)


def noise(template: Template, choose: random.Random) -> dict[str, list[bool | None]]:
    """Values that stay for a while, some of them unknown."""
    columns: dict[str, list[bool | None]] = {}
    for name in template.columns:
        values: list[bool | None] = []
        while len(values) < TICKS:
            value = choose.choice((True, True, False, False, False, None))
            values += [value] * choose.randint(1, 12)
        columns[name] = values[:TICKS]
    return columns


def test_a_late_violation_of_a_pending_demand_has_a_short_window() -> None:
    values: list[bool | None] = [True] * 9_000
    values[8_000:8_003] = [False] * 3
    made = run_of("the robot shall always satisfy q", {"q": values})
    (start,) = made.starts()
    assert start.ticks < 60
    assert start.about.endswith("an obligation from before this window starts at its first tick")


def test_what_is_not_on_the_page_is_counted() -> None:
    """A demand whose trigger is too far away; and more violations than are shown."""
    values: list[bool | None] = [False] * 9_000
    values[0] = True
    far = run_of(
        "whenever p the robot shall within 5000 ticks satisfy q",
        {"p": values, "q": [False] * 9_000},
    )
    assert [*far.starts()] == []
    (note,) = far.notes()
    assert note.endswith(f"what led to it takes more than {MOST} ticks")
    often = run_of("the robot shall always satisfy q", {"q": [True, False] * 30})
    assert len([*often.starts()]) == SHOWN
    assert [*often.notes()] == ["R1: 10 more violations of run.mcap are left out"]


def test_a_window_has_all_signals_and_its_time_in_the_run() -> None:
    columns = {"p": [t == 50 for t in range(100)], "q": [False] * 100}
    times = WholeTicks(np.arange(100) * 100_000_000 + 5, 100_000_000)
    made = {
        name: Column(sum(1 << t for t, v in enumerate(c) if v), 0) for name, c in columns.items()
    }
    subject = requirement("whenever p the sw shall immediately satisfy q")
    others = {"speedy": Column(1 << 50, 0)}
    (start,) = RecordedRun(subject, made, times, "run.mcap", others).starts()
    rows = rows_of(start)
    first = place(start)
    assert [t + first for t, row in enumerate(rows) if row["speedy"]] == [50]
    assert start.place == RecordedPlace("run.mcap", 1, first / 10)
    assert start.about.endswith("; other requirements are judged as if the run began here")
