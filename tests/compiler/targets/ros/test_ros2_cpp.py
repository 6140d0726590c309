"""The package in C++ is whole: its manifest, its build, its tests; its node, beside a stand-in."""

from __future__ import annotations

import subprocess
from itertools import groupby
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package

from compiler.targets.ros.ros2cpp import snake
from tests.effort import FULL, full_only
from tests.programs import needs
from tests.ros2.cpp import built, write_headers, write_real_headers
from tests.ros2.emitted import write
from tests.ros2.launch import launched
from tests.ros2.real.environment import python

ROOT = Path(__file__).parents[4]
FAKE = ROOT / "tests/ros2/rclcpp"
SUBJECTS = ("requirements/r1.fret", "requirements/mission", "requirements/agv")
STRICT = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror".split()


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cpp")
    return write(ROOT / "requirements/r1.fret", folder, "ros2-cpp-package")


@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS)
def test_the_manifest_is_valid_and_names_all_that_is_included(subject: str, tmp_path: Path) -> None:
    package = write(ROOT / subject, tmp_path, "ros2-cpp-package")
    warnings: list[str] = []
    manifest = parse_package(package, warnings=warnings)
    manifest.validate(warnings=warnings)
    assert warnings == []
    assert manifest.get_build_type() == "ament_cmake"
    needed = {each.name for each in manifest.build_depends}
    lines = (package / "src/node.cpp").read_text().splitlines()
    included = {
        line.removeprefix("#include <").split("/")[0]
        for line in lines
        if line.startswith("#include <") and "/" in line
    }
    assert included <= needed
    found = (package / "CMakeLists.txt").read_text()
    for name in needed:
        assert f"find_package({name} " in found


@needs("cmake", "ctest", "make", "cc")
@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS[1:] if FULL else SUBJECTS[:1])
def test_cmake_builds_and_tests_it_without_ros(subject: str, tmp_path: Path) -> None:
    package = write(ROOT / subject, tmp_path, "ros2-cpp-package")
    build = tmp_path / "build"
    commands = (
        f"cmake -S {package} -B {build} -DCMAKE_BUILD_TYPE=Debug",
        f"cmake --build {build}",
        f"ctest --test-dir {build} --output-on-failure",
    )
    for command in map(str.split, commands):
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        assert "warning" not in ran.stderr
    assert "100% tests passed, 0 tests failed out of 1" in ran.stdout


def test_its_stops_are_apart_until_somebody_joins_them(package: Path) -> None:
    launch = launched(package)
    (monitor,) = launch.of("LifecycleNode")
    ((own, argument),) = monitor.remappings
    declared = {each.places[0]: each.default_value for each in launch.of("DeclareLaunchArgument")}
    assert own == declared[argument.places[0]] == "/r1_monitor_cpp/stop"
    assert launch.of("Node") == []


# The node --------------------------------------------------------------------------------------


TYPES = (
    "builtin_interfaces/Time diagnostic_msgs/DiagnosticArray nav_msgs/Odometry std_msgs/Bool "
    "rcl_interfaces/ParameterDescriptor rcl_interfaces/FloatingPointRange std_msgs/String "
    "sensor_msgs/LaserScan"
).split()
FIELDS = {
    "std_msgs/Bool": 'return m.data ? "true" : "false";',
    "std_msgs/String": "return m.data;",
    "diagnostic_msgs/DiagnosticArray": (
        "std::string s; for (const auto & e : m.status) "
        '{s += e.name + "=" + std::to_string(e.level) + "; ";} return s;'
    ),
    "sensor_msgs/LaserScan": (
        "m.angle_increment = 0.01f; m.range_min = 0.01f; m.range_max = 10.0f; "
        "std::string r; while (text >> r) {m.ranges.push_back(std::stof(r));}"
    ),
    "nav_msgs/Odometry": "text >> m.twist.twist.linear.x;",
}


@pytest.fixture(scope="module")
def node(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The emitted node, built with the stand-in for rclcpp and structs of ours as messages."""
    folder = tmp_path_factory.mktemp("node")
    write_headers(folder, TYPES, FIELDS, snake)
    source = package / "src"
    return built(folder, source, source / "node.cpp", (), [*STRICT, f"-I{folder}", f"-I{FAKE}"])


def played(node: Path, *script: str) -> tuple[int, list[tuple[str, str]], str]:
    """The exit status, what was said on which topic, and what was told to anyone who started it."""
    ran = subprocess.run(
        [node], input="\n".join(script), capture_output=True, text=True, check=False
    )
    lines = [line.partition("\t")[::2] for line in ran.stdout.splitlines()]
    return ran.returncode, lines, ran.stderr


BEGIN = ("configure", "activate")
SECOND = 10**9


def known(start: int, speed: float = 0.0) -> list[str]:
    """Half a second of messages of a robot that has nothing near it."""
    found = []
    for i in range(50):
        found.append(f"now {start + i * 10**7}")
        found.append(f"/odom {speed}" if i % 2 else "/scan 3.0")
    return found


def stops(lines: list[tuple[str, str]]) -> list[str]:
    return [text for topic, text in lines if topic == "/r1_monitor_cpp/stop"]


@pytest.mark.slow
def test_the_node_lets_the_robot_go_when_it_knows_and_stops_it_when_a_demand_arrives(
    node: Path,
) -> None:
    script = [*BEGIN, *known(SECOND), "/scan 0.33", "signal", "beat"]
    status, lines, _ = played(node, *script)
    assert status == 0
    assert stops(lines) == ["true", "false", "true", "true"]
    assert ("publisher", "/r1_monitor_cpp/stop: 1 reliable transient local") in lines
    assert ("subscription", "/scan: 5 best effort") in lines


@pytest.mark.slow
def test_the_node_does_the_same_with_the_messages_of_ros_2(
    node: Path, package: Path, tmp_path: Path
) -> None:
    include = python("jazzy").parents[1] / "include"
    options = write_real_headers(tmp_path, TYPES, FIELDS, snake, include)
    source, strict = package / "src", [*STRICT, f"-I{tmp_path}", f"-I{FAKE}", *options]
    real = built(tmp_path, source, source / "node.cpp", (), strict)
    scripts = (
        [*BEGIN, *known(SECOND), "/scan 0.33", "signal", "beat"],
        [*BEGIN, *known(SECOND, 0.5), "/scan nan", "beat", *known(2 * SECOND), "deactivate"],
        [
            *BEGIN,
            *known(SECOND),
            f"offer /scan {SCAN} 255",
            "/scan 3.0",
            "beat",
            *known(2 * SECOND),
        ],
    )
    for script in scripts:
        assert played(real, *script) == played(node, *script)


@pytest.mark.slow
@pytest.mark.parametrize(
    "missing", [["/scan"], ["/odom"], ["/scan", "/odom"], ["now"], ["/scan nan"]]
)
def test_the_node_stops_the_robot_while_it_does_not_know(node: Path, missing: list[str]) -> None:
    script = [
        line.replace("3.0", "nan") if missing == ["/scan nan"] else line
        for line in known(SECOND)
        if line.split()[0] not in missing
    ]
    _, lines, _ = played(node, *BEGIN, *script, "beat", "signal", "beat")
    assert set(stops(lines)) == {"true"}


SCAN = "sensor_msgs/msg/LaserScan"
MEANWHILE = "nothing is known of it meanwhile"


@pytest.mark.slow
def test_another_definition_of_a_type_stops_the_robot_and_is_told_once(node: Path) -> None:
    script = [
        *BEGIN,
        f"offer /scan {SCAN} 17",  # the node's own
        *known(SECOND),
        f"offer /scan {SCAN} 255",
        "/scan 3.0",
        "beat",
        *known(2 * SECOND),
        "beat",
        f"offer /scan {SCAN} 0",  # a publisher that does not state it
        *known(3 * SECOND),
        "offer /scan nav_msgs/msg/Odometry 17",
        "/scan 3.0",
        "withdraw /scan",
        *known(4 * SECOND),
        "signal",
        "beat",
    ]
    _, lines, told = played(node, *script)
    texts = stops(lines)
    assert [text for text, _ in groupby(texts)] == [
        "true", "false", "true", "false", "true", "false", "true",
    ]  # fmt: skip
    what = f"/scan: /robot publishes another definition of {SCAN}, RIHS01_{'ff' * 32}: "
    other = "/scan: /robot publishes nav_msgs/msg/Odometry: "
    assert told == f"{what}{MEANWHILE}{other}{MEANWHILE}"


@full_only("compiled once more")
def test_in_humble_the_node_compares_the_names_of_types(package: Path, tmp_path: Path) -> None:
    write_headers(tmp_path, TYPES, FIELDS, snake)
    source, strict = package / "src", [*STRICT, "-DFAKE_HUMBLE", f"-I{tmp_path}", f"-I{FAKE}"]
    node = built(tmp_path, source, source / "node.cpp", (), strict)
    for offer, expected in ((f"{SCAN} 255", "false"), ("nav_msgs/msg/Odometry 17", "true")):
        script = [*BEGIN, *known(SECOND), f"offer /scan {offer}", "/scan 3.0", "beat", "signal"]
        _, lines, _ = played(node, *script)
        assert stops(lines)[2:-1] == [expected] * (2 if expected == "true" else 1)


@pytest.mark.slow
def test_time_that_goes_back_begins_another_run(node: Path) -> None:
    script = [*BEGIN, *known(100 * SECOND), *known(SECOND), "beat", "signal", "beat"]
    _, lines, _ = played(node, *script)
    assert stops(lines) == ["true", "false", "true", "false", "false", "true"]


@pytest.mark.slow
def test_only_an_active_node_lets_the_robot_go(node: Path) -> None:
    away = ["deactivate", *known(2 * SECOND), "activate", *known(3 * SECOND), "shutdown", "beat"]
    _, lines, _ = played(node, *BEGIN, *known(SECOND), *away)
    assert stops(lines) == ["true", "false", "true", "true", "false", "true"]
    assert [text for topic, text in lines if topic == "state"][-1] == "finalized"
    assert any("node=3" in text for topic, text in lines if topic == "/diagnostics")


@pytest.mark.slow
def test_however_it_ends_the_last_that_it_says_is_a_stop(node: Path) -> None:
    status, lines, told = played(node, *BEGIN, *known(SECOND), "fail")
    assert (status, stops(lines)[-2:]) == (1, ["false", "true"])
    assert told == "r1_monitor_cpp: the middleware is gone\n"
    status, _, _ = played(node, *BEGIN, *known(SECOND), "end", "beat")
    assert status == 4
