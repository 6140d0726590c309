"""`--emit ros1-package`: what catkin, roslaunch and rosparam make of it."""

import subprocess
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from catkin_pkg.package import parse_package_string

from compiler.emit import TARGETS
from compiler.files.text_files import write as deliver
from compiler.project.folder import load
from compiler.project.paths import expanded_paths
from compiler.targets.python import interceptor, monitor
from compiler.targets.target import TargetOptions
from fretish.diagnostics.diagnostic import Diagnostic
from tests.programs import DEBIANS_PATH, DEBIANS_PYTHON, debians_python, installed
from tests.ros1 import ros1_or_skip

ROOT = Path(__file__).parents[4]
PROJECTS = ("requirements/r1.fret", "requirements/mission", "requirements/agv")


def files(path: str) -> dict[str, str]:
    """The texts of a package by their places."""
    paths = expanded_paths([str(ROOT / path)])
    assert not isinstance(paths, Diagnostic)
    project = load(paths)
    options = TargetOptions(declarations=project.declarations, attribution=project.attribution)
    return {
        str(file.path): file.text
        for file in TARGETS["ros1-package"].emit(project.formalized, options)
    }


@pytest.fixture(params=PROJECTS)
def package(request: pytest.FixtureRequest) -> tuple[str, Mapping[str, str]]:
    found = files(request.param)
    (name,) = {path.partition("/")[0] for path in found}
    return name, {path.partition("/")[2]: text for path, text in found.items()}


@pytest.mark.slow
def test_catkin_takes_the_manifest(package: tuple[str, Mapping[str, str]]) -> None:
    name, texts = package
    warnings: list[str] = []
    manifest = parse_package_string(texts["package.xml"], warnings=warnings)
    manifest.validate(warnings)
    assert (manifest.name, warnings) == (name, [])
    needed = {each.name for each in manifest.exec_depends}
    node = texts["scripts/monitor_node.py"]
    types = {line.split('"')[3] for line in node.splitlines() if line.startswith('    "/')}
    assert types
    assert {each.partition("/")[0] for each in types} <= needed


@pytest.mark.slow
def test_what_one_file_names_is_there(package: tuple[str, Mapping[str, str]]) -> None:
    name, texts = package
    launch = ElementTree.fromstring(texts[f"launch/{name}.launch"])
    programs = {f"scripts/{node.attrib['type']}" for node in launch.iter("node")}
    assert programs == {path for path in texts if path.startswith("scripts/")}
    assert all(texts[path].startswith("#!/usr/bin/env python3\n") for path in programs)
    for path in programs:
        assert path in texts["CMakeLists.txt"]
    assert f"config/{name}.yaml" in texts[f"launch/{name}.launch"]
    given = {each.attrib["name"] for each in launch.iter("arg")}
    used = [each.attrib for each in launch.iter("remap")]
    assert {each["to"] for each in used} == {f"$(arg {each})" for each in given}
    defaults = yaml.safe_load(texts[f"config/{name}.yaml"])
    assert set(defaults) == {"source_timeout", "heartbeat", "stop_for"}
    assert defaults["heartbeat"] <= 0.1
    assert set(defaults["stop_for"])


def test_the_monitor_and_the_proved_interceptor_are_those_of_the_other_targets() -> None:
    texts = files("requirements/r1.fret")
    project = load([str(ROOT / "requirements/r1.fret")])
    assert texts["r1_monitor/src/r1_monitor/monitor.py"] == monitor.text(*project.formalized)
    declared = project.declarations
    assert declared is not None
    assert declared.interceptor is not None
    alone = interceptor.text(declared.interceptor, "bindings.toml")
    core, _, _ = alone.partition(interceptor.MARKER)
    ours, _, node = texts["r1_monitor/scripts/interceptor.py"].partition(interceptor.MARKER)
    assert ours.replace("for ROS 1", "for ROS 2") == core
    assert "import rospy" in node


@pytest.mark.slow
def test_catkin_builds_installs_and_launches_it(tmp_path: Path) -> None:
    toplevel = Path("/usr/share/catkin/cmake/toplevel.cmake")
    ros1_or_skip()
    debians_python("catkin")
    installed("cmake")
    installed("roslaunch")
    texts: dict[Path, str | bytes] = {
        tmp_path / "src" / path: text for path, text in files("requirements/r1.fret").items()
    }
    assert deliver({**texts, tmp_path / "src/CMakeLists.txt": toplevel.read_text()}) is None
    clean = {"PATH": DEBIANS_PATH, "HOME": str(tmp_path), "CMAKE_PREFIX_PATH": "/usr"}

    def run(*command: str, **more: str) -> str:
        ran = subprocess.run(
            command,
            cwd=tmp_path,
            env={**clean, **more},
            capture_output=True,
            text=True,
            check=False,
        )
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    at = ["-DCMAKE_INSTALL_PREFIX=installed", f"-DPYTHON_EXECUTABLE={DEBIANS_PYTHON}"]
    run("cmake", "-S", "src", "-B", "build", *at, "-DCATKIN_ENABLE_TESTING=OFF")
    run("cmake", "--build", "build", "--target", "install")
    share = {"ROS_PACKAGE_PATH": str(tmp_path / "installed/share")}
    asked = run("roslaunch", "--nodes", "r1_monitor", "r1_monitor.launch", **share)
    assert set(asked.split()) >= {"/r1_monitor", "/interceptor"}
    said = run(
        str(tmp_path / "installed/lib/r1_monitor/monitor_node.py"),
        "--help",
        PYTHONPATH=str(next(tmp_path.glob("installed/lib/python3*/dist-packages"))),
    )
    assert "/gwendolen_control (Bool)" in said
