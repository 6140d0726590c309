"""Packs: one run keeps all requirements of each, and for each requirement a run breaks it alone."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from compiler.project.packs import pack_names
from tests.command import Fretc
from tests.command import write as put
from tests.effort import FULL
from tests.fretc.logs.logs import MS, S, Sent, write

Value = float | bool
Course = Callable[[float], Value]
"""A value by the time in seconds."""


class Topic(NamedTuple):
    """A topic, and its messages from the values at a time."""

    name: str
    type: str
    period: int
    """Milliseconds."""
    message: Callable[[Mapping[str, Value]], Mapping[str, Any]]


class Case(NamedTuple):
    """A pack, with a run that keeps it and changes that break one requirement each."""

    topics: Sequence[Topic]
    courses: Mapping[str, Course]
    breaks: Mapping[str, Mapping[str, Course]]
    length: int = 30
    """Seconds."""


def steps(first: Value, *changes: tuple[float, Value]) -> Course:
    """A value that changes at some times."""
    return lambda t: [first, *(value for at, value in changes if at <= t)][-1]


def odometry(at: Mapping[str, Value]) -> Mapping[str, Any]:
    return {"twist": {"twist": {"linear": {"x": at["speed"]}, "angular": {"z": at["turn"]}}}}


def scan(at: Mapping[str, Value]) -> Mapping[str, Any]:
    return {"range_min": 0.1, "range_max": 10.0, "ranges": [5.0, at["nearest"], 9.0]}


ODOMETRY = Topic("/odom", "nav_msgs/Odometry", 50, odometry)
SCAN = Topic("/scan", "sensor_msgs/LaserScan", 100, scan)
STANDS = steps(0.25, (3.4, 0.0), (6.5, 0.25), (8.5, 0.2), (12, 0.0))
NAV2 = Case(
    [
        ODOMETRY,
        SCAN,
        Topic(
            "/collision_monitor_state",
            "nav2_msgs/CollisionMonitorState",
            100,
            lambda at: {"action_type": at["monitor"]},
        ),
        Topic(
            "/battery_state",
            "sensor_msgs/BatteryState",
            1000,
            lambda at: {"percentage": at["battery"], "power_supply_status": at["power"]},
        ),
    ],
    {
        "speed": STANDS,
        "turn": steps(0.2, (3.4, 0.0), (6.5, 0.2), (12, 0.0)),
        "nearest": steps(2.0, (3, 0.25), (6, 2.0)),
        "monitor": steps(0, (3, 1), (6, 0), (8, 2), (10, 0)),
        "battery": steps(0.5, (5, 0.19)),
        "power": steps(2, (13, 1)),
    },
    {
        "NAV-1": {"speed": steps(0.25, (12, 0.0)), "nearest": steps(2.0)},
        "NAV-2": {"speed": steps(0.25, (3.4, 0.0), (6.5, 0.4), (12, 0.0))},
        "NAV-3": {"speed": steps(-0.51, (3.4, 0.0))},
        "NAV-4": {"turn": steps(0.2, (1, -2.6), (3, 0.0))},
        "NAV-5": {"speed": steps(0.25, (12, 0.0)), "monitor": steps(0, (8, 2), (10, 0))},
        "NAV-6": {"power": steps(2)},
        "NAV-7": {"turn": steps(0.2, (3.4, 0.0), (20, 0.1))},
    },
    620,
)
TURTLEBOT4 = Case(
    [
        ODOMETRY,
        SCAN,
        Topic(
            "/kidnap_status",
            "irobot_create_msgs/KidnapStatus",
            500,
            lambda at: {"is_kidnapped": at["kidnapped"]},
        ),
        Topic(
            "/dock_status",
            "irobot_create_msgs/DockStatus",
            500,
            lambda at: {"is_docked": at["docked"]},
        ),
        Topic(
            "/stop_status",
            "irobot_create_msgs/StopStatus",
            100,
            lambda at: {"is_stopped": at["stop"]},
        ),
        Topic(
            "/battery_state",
            "sensor_msgs/BatteryState",
            2000,
            lambda at: {"percentage": at["battery"]},
        ),
    ],
    {
        "speed": STANDS,
        "turn": steps(0.2, (3.4, 0.0), (6.5, 0.2), (12, 0.0)),
        "nearest": steps(2.0, (3, 0.19), (6, 2.0)),
        "kidnapped": steps(False, (4, True), (5, False)),
        "docked": steps(False, (13, True)),
        "stop": steps(False, (3.5, True), (6.4, False), (12.1, True)),
        "battery": steps(0.5, (6, 0.19)),
    },
    {
        "TB-1": {"speed": steps(-0.32, (3.4, 0.0))},
        "TB-2": {
            "kidnapped": steps(False, (4, True)),
            "turn": steps(0, (7, 0.1), (9, 0)),
            "speed": steps(0),
        },
        "TB-3": {"docked": steps(False, (1, True)), "stop": steps(False, (20, True))},
        "TB-4": {
            "speed": steps(0.25, (12, 0.0)),
            "turn": steps(0),
            "stop": steps(False),
            "kidnapped": steps(False),
        },
        "TB-5": {"docked": steps(False)},
        "TB-6": {"stop": steps(True, (3, False))},
    },
    620,
)
PX4 = Case(
    [
        Topic(
            "/vehicle_status",
            "px4_msgs/VehicleStatus",
            100,
            lambda at: {
                "nav_state": at["mode"],
                "arming_state": 2 if at["armed"] else 1,
                "failsafe": at["failsafe"],
            },
        ),
        Topic(
            "/vehicle_land_detected",
            "px4_msgs/VehicleLandDetected",
            500,
            lambda at: {"landed": at["landed"]},
        ),
        Topic(
            "/battery_status",
            "px4_msgs/BatteryStatus",
            200,
            lambda at: {"remaining": at["battery"], "warning": at["warning"]},
        ),
        Topic(
            "/failsafe_flags",
            "px4_msgs/FailsafeFlags",
            500,
            lambda at: {
                "manual_control_signal_lost": at["manual_lost"],
                "offboard_control_signal_lost": at["offboard_lost"],
                "geofence_breached": at["breached"],
            },
        ),
    ],
    {
        # takeoff, remote control, its loss, offboard, its loss, critical and empty battery
        "mode": steps(17, (2, 2), (4.5, 5), (6, 2), (7, 14), (8.4, 2), (12, 5), (18, 18)),
        "armed": steps(False, (0.5, True), (26, False)),
        "failsafe": steps(False, (4.5, True), (6, False), (9, True), (11, False), (12, True)),
        "landed": steps(True, (1, False), (24, True)),
        "battery": steps(0.5, (10, 0.07), (16, 0.05)),
        "warning": steps(0, (10, 2), (16, 3)),
        "manual_lost": steps(False, (4, True), (6, False)),
        "offboard_lost": steps(True, (6, False), (8, True)),
        "breached": steps(False, (9, True), (11, False)),
    },
    {
        "PX4-1": {
            "failsafe": steps(False, (9, True)),
            "mode": steps(2, (7, 14), (8.4, 2), (12, 5), (18, 18)),
        },
        "PX4-2": {"mode": steps(2, (7, 14), (12, 5), (18, 18))},
        "PX4-3": {"mode": steps(2, (7, 14), (8.4, 2), (18, 18))},
        "PX4-4": {"mode": steps(2, (7, 14), (8.4, 2), (12, 5))},
        "PX4-5": {"failsafe": steps(False, (4.5, True), (6, False))},
        "PX4-6": {"armed": steps(True)},
        "PX4-7": {"armed": steps(False, (0.5, True), (20, False))},
        "PX4-8": {"battery": steps(0.5, (16, 0.049))},
    },
)
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
LEROBOT = Case(
    [
        Topic(
            "/table",
            "lerobot",
            100,
            lambda at: {
                "observation": {"state": [at[name] for name in JOINTS]},
                "action": [at[f"{name}_goal"] for name in JOINTS],
            },
        )
    ],
    {
        **{name: steps(0.0, (2, 20.0), (3, 0.0)) for name in JOINTS},
        **{f"{name}_goal": steps(0.0, (1.5, 20.0), (2.5, 0.0)) for name in JOINTS},
        "gripper": steps(50.0),
        "gripper_goal": steps(50.0, (4, 10.0), (8, 50.0)),
    },
    {
        "ARM-1": {"wrist_roll": steps(0.0, (5, -101.0))},
        "ARM-2": {"gripper_goal": steps(50.0, (1, -1.0), (2, 50.0), (4, 10.0), (8, 50.0))},
        "ARM-3": {"elbow_flex_goal": steps(0.0, (5, 41.0))},
        "ARM-4": {"shoulder_lift": steps(0.0), "shoulder_lift_goal": steps(0.0, (5, 20.0))},
        "ARM-5": {"gripper_goal": steps(50.0, (4, 10.0))},
    },
)
ARDUPILOT = Case(
    [
        Topic("/MODE", "dataflash/MODE", 1000, lambda at: {"Mode": at["mode"]}),
        Topic("/CTUN", "dataflash/CTUN", 100, lambda at: {"Alt": at["altitude"]}),
        Topic(
            "/ATT",
            "dataflash/ATT",
            50,
            lambda at: {
                "Roll": at["roll"],
                "Pitch": at["pitch"],
                "DesRoll": at["roll_demand"],
                "DesPitch": 0.0,
            },
        ),
        Topic("/VIBE", "dataflash/VIBE", 100, lambda at: {"VibeZ": at["vibration"]}),
        Topic("/GPS", "dataflash/GPS", 200, lambda at: {"NSats": at["satellites"]}),
        Topic("/BAT", "dataflash/BAT", 100, lambda at: {"Volt": at["voltage"]}),
    ],
    {
        "mode": steps(5, (22, 6)),
        "altitude": steps(0.0, (1, 30.0), (28, 0.0)),
        "roll": steps(0.0, (3, 30.0), (4, 0.0)),
        "roll_demand": steps(0.0, (2.8, 30.0), (4, 0.0)),
        "pitch": steps(5.0),
        "vibration": steps(12.0),
        "satellites": steps(11, (6, 5), (7, 9)),
        "voltage": steps(15.2, (12, 13.9)),
    },
    {
        "AP-1": {
            "roll": steps(0.0, (3, 51.0), (4, 0.0)),
            "roll_demand": steps(0, (3, 45.0), (4, 0)),
        },
        "AP-2": {"roll": steps(0.0)},
        "AP-3": {"vibration": steps(12.0, (9, 61.0))},
        "AP-4": {"satellites": steps(11, (6, 5))},
        "AP-5": {"mode": steps(5)},
        "AP-6": {"altitude": steps(0.0, (1, 101.0), (28, 0.0))},
    },
)
CASES = {
    "ardupilot": ARDUPILOT,
    "lerobot": LEROBOT,
    "nav2": NAV2,
    "px4": PX4,
    "turtlebot4": TURTLEBOT4,
}


def record(path: Path, case: Case, changes: Mapping[str, Course], length: int) -> None:
    courses = {**case.courses, **changes}
    sent = []
    for topic in case.topics:
        for ms in range(0, length * 1000, topic.period):
            at = {name: course(ms / 1000) for name, course in courses.items()}
            text = json.dumps(topic.message(at)).encode()
            sent.append(Sent(topic.name, topic.type, text, 1000 * S + ms * MS, None, "json"))
    write(path, sorted(sent, key=lambda each: each.time))


def verdicts(fretc: Fretc, log: str) -> dict[str, str]:
    fretc("audit", log, "--output", "evidence.json")
    results = json.loads(Path("evidence.json").read_text("utf-8"))["results"]
    return {each["requirement"]: each["verdict"] for each in results}


def test_all_packs_have_a_case_and_are_in_the_help(fretc: Fretc) -> None:
    assert [*CASES] == pack_names()
    text = fretc("init", "--help").out
    assert all(f"`{name}`" in text for name in CASES)


@pytest.mark.parametrize("name", CASES)
def test_a_pack_has_no_error_or_warning(fretc: Fretc, name: str) -> None:
    assert fretc("init", "--pack", name).status == 0
    run = fretc("check")
    assert run.status == 0
    assert f"{len(CASES[name].breaks)} requirements: 0 errors, 0 warnings" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_one_run_keeps_a_pack_and_each_requirement_can_be_broken(fretc: Fretc, name: str) -> None:
    case = CASES[name]
    fretc("init", "--pack", name)
    record(Path("keeps.mcap"), case, {}, 30)
    assert verdicts(fretc, "keeps.mcap") == dict.fromkeys(case.breaks, "satisfied")
    for id, changes in case.breaks.items():
        is_late = id in ("NAV-6", "TB-5")  # It can be broken after ten minutes.
        if is_late and not FULL:
            continue
        record(Path(f"{id}.mcap"), case, changes, case.length if is_late else 30)
        broken = verdicts(fretc, f"{id}.mcap")
        assert {each for each, verdict in broken.items() if verdict == "violated"} == {id}


def test_a_folder_is_a_pack(fretc: Fretc) -> None:
    put("mine/a.fret", '+++\nid = "A"\n+++\nthe robot shall always satisfy p\n')
    put("mine/notes.txt", "not part of it")
    assert fretc("init", "--pack", "mine", "new").status == 0
    assert sorted(each.name for each in Path("new/requirements").iterdir()) == [
        "a.fret",
        "fretc.toml",
    ]


def test_an_unknown_pack_is_refused(fretc: Fretc) -> None:
    run = fretc("init", "--pack", "nav3", "new")
    assert run.status == 2
    assert run.err == (
        "F901 there is no pack `nav3`\n"
        f"help: name one of {', '.join(CASES)}, or a folder with `.fret` files\n"
    )
    assert not Path("new").exists()


def test_a_pack_with_an_error_is_refused_whole(fretc: Fretc) -> None:
    put("mine/a.fret", '+++\nid = "A"\n+++\nthe robot shall always satisfy p\n')
    put("mine/b.fret", '+++\nid = "B"\n+++\nthe robot should always satisfy p\n')
    run = fretc("init", "--pack", "mine", "new")
    assert run.status == 2
    assert "mine/b.fret:4:11" in run.err
    assert not Path("new").exists()


def test_settings_above_a_pack_are_not_part_of_it(fretc: Fretc) -> None:
    put("packs/fretc.toml", "viewer = 1\n")
    put("packs/mine/a.fret", '+++\nid = "A"\n+++\nthe robot shall always satisfy p\n')
    assert fretc("init", "--pack", "packs/mine", "new").status == 0


def test_a_pack_and_a_log_are_refused(fretc: Fretc) -> None:
    run = fretc("init", "--pack", "nav2", "--from", "run.mcap")
    assert (run.status, run.err.split(" ")[0]) == (2, "F907")


@pytest.mark.slow
def test_of_many_propositions_that_never_change_a_few_are_told_and_the_others_counted(
    fretc: Fretc,
) -> None:
    still = dict.fromkeys(PX4.courses, steps(0)) | {"mode": steps(2), "battery": steps(0.5)}
    fretc("init", "--pack", "px4")
    record(Path("still.mcap"), PX4, still, 5)
    short, whole = (fretc("audit", "still.mcap", *option).err for option in ((), ("-v",)))
    count = whole.count("F314 note")
    assert count > 3
    assert short.count("F314 note") == 3
    assert f"\n{count - 3} more propositions never changed (F314): `-v` lists them\n" in short
    assert "more propositions never changed" not in whole
