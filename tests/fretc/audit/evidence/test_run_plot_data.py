"""The way of the robot is where it was recorded, within the error that is stated."""

from collections.abc import Sequence
from math import dist
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from compiler.files.records import plain
from fretc.audit.evidence.reader import EvidenceFile, read
from fretc.audit.evidence.run_plot_data import plot_data, position_at
from fretc.audit.evidence.schema import MOST_POINTS, MOST_WORDS, Result, RobotPath
from fretc.logs.signals.samples import Recording, Samples
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from tests.command import Fretc
from tests.command import write as put
from tests.fretc.logs.logs import MS, S, Sent, declare, payload, write

BINDINGS = """
[clock]
tick = "100 ms"
[signal.mode]
path = "/mode.data"
values = ["drive", "docking"]
max_age = "1 s"
[signal.x]
path = "/odom.pose.pose.position.x"
unit = "cm"
"""
MAP = """
[map]
x = "/odom.pose.pose.position.x"
y = "/odom.pose.pose.position.y"
"""


def log(x: Samples, y: Samples, **changes: Any) -> Recording:
    none = np.array([], np.int64)
    of: dict[str, Any] = {"samples": {}, "gaps": (), **changes}
    return Recording(
        name="a.mcap",
        sha256="",
        size=1,
        start_ns=0,
        end_ns=10**12,
        ticks=none,
        topics={},
        nearest={},
        findings=(),
        intact=True,
        beside={"[map] x": x, "[map] y": y},
        **of,
    )


def way(rows: Sequence[tuple[int, float, float]], **changes: Any) -> RobotPath | None:
    times = np.array([time for time, _, _ in rows], np.int64) * MS
    x, y = (Samples(times, np.array([row[n] for row in rows])) for n in (1, 2))
    found = plot_data(log(x, y, **changes), declare(BINDINGS + MAP))
    return found.way if found else None


def test_a_coordinate_is_read_as_its_signal_is_and_else_in_metres() -> None:
    drawn = declare(BINDINGS + MAP).map
    assert drawn is not None
    assert (drawn.x.unit_name, drawn.y.unit_name) == ("cm", "m")
    assert (drawn.x.name, drawn.y.name) == ("[map] x", "[map] y")


def test_a_mistake_in_the_map_has_its_place() -> None:
    wrong = BINDINGS + '[map]\nx = "/mode.data"\nz = 1\n'
    declarations, diagnostics = read_bindings(Source("bindings.toml", wrong))
    assert declarations is not None
    assert declarations.mistakes.keys() == {("map", "")}, "nothing that reads the map goes on"
    places = [(d.code.number, d.span.line if d.span else 0, d.message) for d in diagnostics]
    assert places == [
        ("F302", 13, "unknown field `z` in [map]"),
        ("F303", 12, "`x` of the map must be a length, and `mode` is in plain numbers"),
        ("F303", 11, "`y` of the map must be a topic and one number of its messages"),
    ]


steps = st.tuples(
    st.sampled_from([20, 20, 20, 100, 3000]),
    st.floats(-1, 1) | st.just(float("nan")),
    st.floats(-1, 1) | st.sampled_from([float("inf"), 0.0]),
)


@pytest.mark.slow
@given(st.lists(steps, min_size=1, max_size=40), st.integers(1, 40))
@settings(deadline=None, max_examples=40, phases=(Phase.generate,))
def test_the_way_is_where_the_robot_was_within_its_error(
    drawn: list[tuple[int, float, float]], often: int
) -> None:
    rows, time, x, y = [], 0, 0.0, 0.0
    for late, right, up in drawn * often:
        time += late
        known = np.isfinite(right) and np.isfinite(up)
        x, y = (x + right, y + up) if known else (x, y)
        rows.append((time, x if known else right, y if known else up))
    found = way(rows)
    known_rows = [row for row in rows if np.isfinite(row[1]) and np.isfinite(row[2])]
    if found is None:
        assert not known_rows
        return
    assert len(found.times_ns) <= MOST_POINTS
    for at, right, up in known_rows:
        there = position_at(found, at * MS)
        if there is None:
            assert found.lines_left_out
        else:
            assert dist(there, (right, up)) <= float(found.error) + 1e-9


def test_unknown_places_pauses_and_losses_break_the_line() -> None:
    nan = float("nan")
    rows = [(t, t / 100, 0.0) for t in range(0, 10_000, 100)]
    assert [*(way(rows) or RobotPath((), (), (), (), 0, 0)).starts] == [0]
    hole = [(t, nan if t == 5000 else x, y) for t, x, y in rows]
    late = [(t + 2000 * (t > 5000), x, y) for t, x, y in rows]
    for broken in (way(hole), way(late), way(rows, gaps=((5050 * MS, 5060 * MS),))):
        assert broken is not None
        assert [*broken.starts] == [0, 2]
        assert len(broken.times_ns) == 4


def test_words_are_their_changes_and_unknown_where_they_are_too_old() -> None:
    times = np.array([0, 500, 900, 5000, 5500], np.int64) * MS
    mode = Samples(times, np.array([0.0, 0.0, 1.0, 1.0, 0.0]), words=("drive", "docking"))
    nothing = Samples(np.array([], np.int64), np.array([]))
    found = plot_data(log(nothing, nothing, samples={"mode": mode}), declare(BINDINGS + MAP))
    assert found is not None
    assert found.way is None
    (words,) = found.words.values()
    late = 1900 * MS + 1
    assert (words.times_ns, words.words) == (
        (0, 900 * MS, late, 5000 * MS, 5500 * MS, 6500 * MS + 1),
        ("drive", "docking", None, "docking", "drive", None),
    )
    many = Samples(np.arange(900) * 100 * MS, np.arange(900) % 2.0, words=("drive", "docking"))
    short = plot_data(log(nothing, nothing, samples={"mode": many}), declare(BINDINGS + MAP))
    assert short is not None
    assert len(short.words["mode"].words) == MOST_WORDS
    assert short.words["mode"].changes_left_out == 901 - MOST_WORDS


# Nothing else depends on it ----------------------------------------------------------------------

STRING, POINT = "std_msgs/msg/String", "geometry_msgs/msg/Point"
RULES = """
[clock]
tick = "100 ms"
[signal.vx]
path = "/at.z"
unit = "m/s"
[proposition.slow]
expr = "vx < 0.5 m/s"
"""


def sent() -> list[Sent]:
    found = []
    for i in range(30):
        time = 1000 * S + i * 100 * MS
        point = payload(POINT, x=i / 10, y=0.0, z=0.6 if i > 20 else 0.1)
        found.append(Sent("/at", POINT, point, time))
        found.append(Sent("/early", STRING, payload(STRING, data="a"), time - 500 * MS))
    return found


def audited(fretc: Fretc, name: str, bindings: str) -> tuple[list[Result], str]:
    put("requirements/r.fret", "the agv shall always satisfy slow\n")
    put("requirements/bindings.toml", bindings)
    outcome = fretc("audit", "log.mcap", "-o", name)
    found = read(name)
    assert isinstance(found, EvidenceFile), found
    return [*found.results], outcome.err


def test_a_map_changes_nothing_else_of_the_evidence(fretc: Fretc) -> None:
    write(Path("log.mcap"), sent())
    (before,), _ = audited(fretc, "a.json", RULES)
    drawn = '[map]\nx = "/at.x"\ny = "/at.y"\n'
    (after,), words = audited(fretc, "b.json", RULES + drawn)
    assert "F428" not in words
    assert after.course
    assert after.course.way is not None
    assert after.course.way.x == (0.0, 2.9)
    assert {**plain(after), "course": None} == {**plain(before), "course": None}
    (other,), words = audited(fretc, "c.json", RULES + drawn.replace("/at", "/early"))
    assert "F428 warning: no map can be drawn" in words
    assert plain(other) == plain(before)
    assert fretc("verify-evidence", "c.json").status == 0
    put("requirements/bindings.toml", RULES)
    assert fretc("check", "--evidence", "b.json").out.count("suspect") == 0
