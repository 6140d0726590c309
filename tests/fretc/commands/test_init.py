"""`fretc init`: a project in a minute, and nothing of the user's is touched."""

import json
import shutil
import struct
from decimal import Decimal
from pathlib import Path

import pyarrow
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.bindings.starter_files import UpperLimit, first_requirement
from fretc.audit.bindings.starter_files import _limit as limit
from tests.command import Fretc
from tests.command import write as put
from tests.fretc.logs.logs import MS, TWELVE, S, Sent, number, write

ROOT = Path(__file__).parents[3]
NAMES = ("r1.fret", "bindings.toml", "hazards.toml", "fretc.toml")


def odometry() -> list[Sent]:
    """A well-known type with a unit beside numbers without one."""
    return [
        Sent(
            "/cmd_vel",
            "geometry_msgs/msg/Twist",
            b"\x00\x01\x00\x00" + struct.pack("<6d", i / 40, 0, 0, 0, 0, 0),
            1000 * S + i * 100 * MS,
        )
        for i in range(12)
    ]


def strange() -> list[Sent]:
    """A type that nobody knows, in JSON; its first number is always the same."""
    return [
        Sent(
            "/pump",
            "acme/Pump",
            b'{"charge": 0, "flow rate": 1, "flow": %d.5, "valve": "%s"}'
            % (i, b"open" if i < 9 else b"shut"),
            1000 * S + i * 100 * MS,
            None,
            "json",
        )
        for i in range(12)
    ]


def states() -> dict[Path, bytes | None]:
    return {path: path.read_bytes() if path.is_file() else None for path in Path().rglob("*")}


def test_a_project_without_a_log_has_no_mistake(fretc: Fretc) -> None:
    run = fretc("init")
    assert (run.status, run.out) == (0, "")
    assert run.err == (
        "wrote requirements/r1.fret\nwrote requirements/bindings.toml\n"
        "wrote requirements/hazards.toml\n"
        "wrote requirements/fretc.toml\n"
        "next: replace each `To do` in requirements\n"
        "next: `fretc check` reports mistakes\n"
        "next: `fretc audit LOG` checks a log against the requirements\n"
    )
    run = fretc("check")
    assert (run.status, run.err) == (0, "1 requirement: 0 errors, 0 warnings\n")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["plain", "typed", "both", "strange"])
def test_a_project_from_a_log_has_no_mistake_and_judges_that_log(fretc: Fretc, kind: str) -> None:
    sent = {
        "plain": TWELVE,
        "typed": odometry(),
        "both": [*TWELVE, *odometry()],
        "strange": strange(),
    }[kind]
    write(Path("a run.mcap"), sorted(sent, key=lambda message: message.time))
    run = fretc("init", "new project", "--from", "a run.mcap")
    assert run.status == 0
    assert run.err.endswith(
        "next: `fretc audit 'a run.mcap' --requirements 'new project/requirements'` checks a log "
        "against the requirements\n"
    )
    check = fretc("check", "--requirements", "new project/requirements")
    assert (check.status, check.err) == (0, "1 requirement: 0 errors, 0 warnings\n")
    audit = fretc("audit", "a run.mcap", "--requirements", "new project/requirements")
    assert audit.status == 0
    (result,) = json.loads(Path("build/evidence.json").read_text())["results"]
    assert (result["requirement"], result["verdict"]) == ("R1", "satisfied")
    sentence = Path("new project/requirements/r1.fret").read_text()
    assert ("satisfy cmd_vel_vx <= 0.28\n" in sentence) == (kind in ("typed", "both"))
    assert ("satisfy pump_flow <= 12\n" in sentence) == (kind == "strange")
    bindings = Path("new project/requirements/bindings.toml").read_text()
    assert "[proposition" not in bindings
    assert ('values = ["open", "shut"]' in bindings) == (kind == "strange")
    assert "a guess" not in bindings


@pytest.mark.slow
def test_a_project_from_the_recorded_mission_judges_it(fretc: Fretc) -> None:
    log = str(ROOT / "traces/mission-seed15.mcap")
    assert fretc("init", "--from", log).status == 0
    assert fretc("check").status == 0
    assert fretc("audit", log).status == 0


def sent(topic: str, type_: str, period: int, *messages: dict[str, float]) -> list[Sent]:
    """JSON messages at a period in milliseconds."""
    return [
        Sent(topic, type_, json.dumps(each).encode(), 1000 * S + i * period * MS, None, "json")
        for i, each in enumerate(messages)
    ]


def drafted(fretc: Fretc, messages: list[Sent]) -> tuple[str, str]:
    """The sentence and the bindings of a project from a log with these messages."""
    write(Path("run.mcap"), sorted(messages, key=lambda message: message.time))
    assert fretc("init", "--from", "run.mcap").status == 0
    folder = Path("requirements")
    return (folder / "r1.fret").read_text().splitlines()[-1], (folder / "bindings.toml").read_text()


@pytest.mark.parametrize("most", [0.9, 1.0, 1.2, 90.0])
def test_a_percentage_from_0_to_100_has_its_unit(fretc: Fretc, most: float) -> None:
    type_ = "sensor_msgs/BatteryState"
    values = [{"percentage": most - i / 100} for i in range(20)]
    _, bindings = drafted(fretc, sent("/battery", type_, 100, *values))
    assert ('unit = "%"' in bindings) == (most == 90)
    assert ("from 0 to 100 in this log" in bindings) == (most == 90)


def test_the_first_requirement_is_about_a_measurement_and_its_topic_sets_the_tick(
    fretc: Fretc,
) -> None:
    numbers = [{"a_timestamp": 1.5 * i, "seq": i, "weight": 3 + i, "volts": 2} for i in range(40)]
    states = [{"id": i, "voltage": 12 + i / 10} for i in range(40)]
    messages = sent("/a", "x/A", 200, *numbers) + sent("/b", "x/B", 20, *states)
    sentence, bindings = drafted(fretc, messages)
    assert sentence == "the robot shall always satisfy b_voltage <= 16"
    assert 'tick = "20 ms"  # /b comes every 20 ms' in bindings


def test_a_column_of_a_table_has_its_own_name(fretc: Fretc) -> None:
    put("run.csv", "t_s,battery\n" + "".join(f"{i / 10},{20 - i}\n" for i in range(15)))
    assert fretc("init", "--from", "run.csv").status == 0
    assert Path("requirements/r1.fret").read_text().endswith(" battery <= 20\n")


@pytest.mark.slow
def test_a_project_is_drafted_from_the_first_of_several_runs_of_a_table(fretc: Fretc) -> None:
    rows = {"episode_index": [0] * 12 + [1] * 12, "timestamp": [i / 10 for i in range(12)] * 2}
    rows["speed"] = [float(i) for i in range(24)]
    pyarrow.parquet.write_table(pyarrow.table(rows), "runs.parquet")
    assert fretc("init", "--from", "runs.parquet").status == 0
    assert Path("requirements/r1.fret").read_text().endswith(" speed <= 11\n")


@pytest.mark.parametrize("there", [*NAMES, "mine.txt"])
def test_nothing_is_written_where_anything_is_there(fretc: Fretc, there: str) -> None:
    put(f"requirements/{there}", "mine")
    before = states()
    run = fretc("init")
    assert (run.status, run.err.splitlines()[0]) == (2, "F905 `requirements` already exists")
    assert states() == before


def test_an_empty_folder_is_filled_and_a_file_in_its_place_is_left(fretc: Fretc) -> None:
    Path("a/requirements").mkdir(parents=True)
    assert fretc("init", "a").status == 0
    assert sorted(path.name for path in Path("a/requirements").iterdir()) == sorted(NAMES)
    put("b/requirements", "mine")
    put("c", "mine")
    before = states()
    assert fretc("init", "b").status == fretc("init", "c").status == 2
    assert states() == before


@pytest.mark.parametrize("log", ["none.mcap", "text.mcap", "empty.mcap", "nan.mcap", "-"])
def test_a_log_that_gives_no_signal_leaves_nothing(fretc: Fretc, log: str) -> None:
    put("text.mcap", "no log")
    write(Path("empty.mcap"), [])
    write(Path("nan.mcap"), [number(float("nan"), 1000 * S + i * 100 * MS) for i in range(12)])
    before = states()
    run = fretc("init", "--from", log)
    assert run.status == 2
    assert run.err.startswith("F")
    assert states() == before


def test_what_is_found_in_the_log_is_said(fretc: Fretc) -> None:
    write(Path("run.mcap"), TWELVE, per_chunk=3)
    shutil.copy("run.mcap", "cut.mcap")
    data = Path("cut.mcap").read_bytes()
    Path("cut.mcap").write_bytes(data[: len(data) * 3 // 4])
    assert "F4" in fretc("init", "--from", "cut.mcap").err


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_limit_is_no_less_than_the_value_and_close_to_it(value: float) -> None:
    found, exact = Decimal(limit(value)), Decimal(value)
    assert found >= exact
    assert found - exact <= abs(exact) / 10
    assert len(found.normalize().as_tuple().digits) <= 3


def test_one_function_writes_the_first_requirement() -> None:
    found = first_requirement(UpperLimit("vx", "0.4", "m/s"), "is an example.")
    assert found.sentence == "the robot shall always satisfy vx <= 0.4"
    assert found.text == "vx is at most 0.4 m/s, always."
