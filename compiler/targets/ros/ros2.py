"""`--emit ros2-package`: a package of ROS 2 in Python (`ament_python`), ready for colcon."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePosixPath
from textwrap import wrap
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import interceptor, monitor
from compiler.targets.ros import package as shared
from compiler.targets.ros.package import Package, SubscribedTopic
from compiler.targets.target import DEFAULT, LOOP, Target, TargetOptions

_SENSORS = {"sensor_msgs", "nav_msgs"}
"""Packages of messages that drivers publish with best effort."""
_NODE = {
    "diagnostic_msgs.msg": "DiagnosticArray, DiagnosticStatus, KeyValue",
    "rcl_interfaces.msg": "FloatingPointRange, ParameterDescriptor",
    "rclpy": "",
    "rclpy.clock": "Clock, ClockType",
    "rclpy.duration": "Duration",
    "rclpy.executors": "ExternalShutdownException, SingleThreadedExecutor",
    "rclpy.lifecycle": "LifecycleNode, TransitionCallbackReturn",
    "rclpy.qos": "DurabilityPolicy, qos_profile_sensor_data, QoSProfile",
    "rclpy.signals": "SignalHandlerOptions",
    "std_msgs.msg": "Bool, String",
}
"""The node's imports from ROS packages; an empty value imports the module itself."""
_NEEDED = ("launch", "launch_ros", "lifecycle_msgs", "rcl_interfaces", "rclpy")
_TEMPLATES = {
    "package.xml": "package.xml.j2",
    "setup.py": "setup.py.j2",
    "setup.cfg": "setup.cfg.j2",
    "{name}/__main__.py": "main.py.j2",
    "{name}/node.py": "node.py.j2",
    "launch/{name}.launch.py": "launch.py.j2",
    "config/{name}.yaml": "config.yaml.j2",
    "test/test_node.py": "test_node.py.j2",
    "test/test_linters.py": "test_linters.py.j2",
    "test/flake8.ini": "flake8.ini.j2",
}
"""The files that only ROS 2 packages in Python have."""
_CONTAINER = {
    "Dockerfile": "Dockerfile.j2",
    ".github/workflows/ros2.yml": "workflow.yml.j2",
}


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """A folder with the name of the package.

    Raises:
        AssertionError: some requirement had to be refused.
    """
    package = shared.package(requirements, options)
    folder = PurePosixPath(package.name)
    return tuple(Artifact(folder / path, text) for path, text in _files(package).items())


def _files(package: Package) -> dict[str, str]:
    name = package.name
    files = {
        path.format(name=name): render(f"ros2/{template}", **_values(package))
        for path, template in _TEMPLATES.items()
    }
    files |= {f"{name}/{file}": text for file, text in shared.modules(package).items()}
    files |= shared.documents(package, 2)
    files |= container(package)
    files |= {f"resource/{name}": "", f"{name}/__init__.py": ""}
    files["test/test_monitor.py"] = shared.tests(package)
    if package.interception is not None:
        node = replace(package.interception, ros=2)
        files[f"{name}/interceptor.py"] = interceptor.text(node, package.bindings)
    return files


def container(package: Package) -> dict[str, str]:
    """What builds the package and runs its tests on ROS 2: for Docker, and for GitHub."""
    return {
        path: render(f"ros2/{template}", package=package, version=__version__)
        for path, template in _CONTAINER.items()
    }


def _values(package: Package) -> dict[str, Any]:
    messages = {f"{topic.package}.msg": "" for topic in package.topics}
    lines = sorted((*_NODE.items(), *messages.items()))
    return {
        "package": package,
        "apart": False,
        "keeps": any(topic.is_kept for topic in package.topics),
        "version": __version__,
        "dependencies": sorted({*_NEEDED, *package.dependencies}),
        "imports": [
            f"from {at} import {names}" if names else f"import {at}" for at, names in lines
        ],
        "sources": [
            (topic.name, f"{topic.package}.msg.{topic.message}", qos(topic))
            for topic in package.topics
        ],
        "parameters": [
            (parameter, _literal(parameter.value), wrap(parameter.text, 80, drop_whitespace=False))
            for parameter in package.parameters
        ],
    }


def _literal(value: float | Sequence[str]) -> str:
    """The value as a literal of Python and YAML."""
    return repr(value) if isinstance(value, float) else json.dumps(list(value))


def qos(topic: SubscribedTopic) -> str:
    """The QoS of the node's subscription, as Python code."""
    if topic.is_kept:
        return "KEPT_ALL"
    if topic.package == "tf2_msgs":
        return "100"
    return "qos_profile_sensor_data" if topic.package in _SENSORS else "10"


TARGET = Target(
    "ros2-package",
    "a package of ROS 2: monitor, lifecycle node, interceptor, launch file, tests",
    emit,
    shared.refuse,
    monitor.remark,
    remarks=shared.remarks,
    refuse_project=shared.refuse_project,
    per_rule=False,
    together=True,
    reads=LOOP,
    next_step="`colcon build` builds it, in the `src` of a workspace",
)
