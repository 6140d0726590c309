"""An emitted package of ROS 2 in a world of its own: its two nodes, and a robot around them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.emit import TARGETS
from compiler.files.attribution import Attribution
from compiler.project.folder import load
from compiler.project.paths import expanded_paths
from compiler.targets.target import TargetOptions
from fretish.diagnostics.diagnostic import Severity
from tests.ros2.messages import message_class
from tests.ros2.world import Process, World

OWNER = Attribution("Ada Meier", "ada@robots.org", "0BSD", "Stops the robot")
FORWARD = 0.4
"""Metres per second that the planner wants."""


def write(requirements: Path, folder: Path, kind: str = "ros2-package") -> Path:
    """The package of a folder of requirements; its folder."""
    target = TARGETS[kind]
    paths = expanded_paths([str(requirements)])
    assert isinstance(paths, list)
    project = load(paths)
    assert {each.severity for each in project.diagnostics} <= {Severity.WARNING}
    assert [
        no.message for requirement in project.formalized if (no := target.refuse(requirement))
    ] == []
    options = TargetOptions(declarations=project.declarations, attribution=OWNER)
    assert target.refuse_project(options) is None
    artifacts = target.emit(project.formalized, options)
    for artifact in artifacts:
        path = folder / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")
    return folder / artifacts[0].path.parts[0]


@dataclass
class Monitor:
    """The monitor's process, in the world."""

    process: Process
    module: Any
    node: Any

    def change(self, *transitions: str) -> list[bool]:
        return [self.node.change(each) for each in transitions]


class Robot:
    """The world of R1's robot: what stands still and has nothing near it, unless a test says so."""

    def __init__(self, package: Path) -> None:
        self.world, self.package = World(), package
        self.range, self.speed = 3.0, 0.0
        self.scans = self.odometry = self.plans = True
        """Whether the drivers and the planner speak."""
        self.obeys = False
        """Whether it moves as its wheels are reported, and not by `speed`."""
        self._node = self.world.node("robot")
        sensor = self._node.process.modules["rclpy.qos"].qos_profile_sensor_data
        self._scan = self._publisher("sensor_msgs/LaserScan", "/scan", sensor)
        self._odometry = self._publisher("nav_msgs/Odometry", "/odom", 10)
        self._command = self._publisher("geometry_msgs/Twist", "/cmd_vel", 10)
        self._again(100, self._scans)
        self._again(50, self._odometries)
        self._again(50, self._commands)

    def _publisher(self, kind: str, topic: str, qos: Any) -> Any:
        return self._node.create_publisher(message_class(kind), topic, qos)

    def _again(self, milliseconds: int, call: Any) -> None:
        def ring() -> None:
            self.world.after(milliseconds * 10**6, self._node, ring)
            call()

        self.world.after(10**6, self._node, ring)

    def scan(self, *ranges: float) -> Any:
        """A scan of some beams, straight ahead and to the left."""
        return message_class("sensor_msgs/LaserScan")(
            angle_increment=0.01, range_min=0.01, range_max=10.0, ranges=list(ranges)
        )

    def see(self, *ranges: float) -> None:
        """One more scan, now."""
        self._scan.publish(self.scan(*ranges))

    def _scans(self) -> None:
        if self.scans:
            self.see(self.range)

    def _odometries(self) -> None:
        if self.odometry:
            message = message_class("nav_msgs/Odometry")()
            message.twist.twist.linear.x = self.wheels if self.obeys else self.speed
            self._odometry.publish(message)

    def _commands(self) -> None:
        if self.plans:
            message = message_class("geometry_msgs/Twist")()
            message.linear.x = FORWARD
            self._command.publish(message)

    # The package

    def monitor(self, *arguments: str, activate: bool = True) -> Monitor:
        """The monitor's process starts, and is activated."""
        process = self.world.process(*arguments)
        module = process.load(self.package, "node")
        process.init()
        found = Monitor(process, module, module.MonitorNode())
        if activate:
            assert found.change("configure", "activate") == [True, True]
        return found

    def interceptor(self, *arguments: str) -> Process:
        """The interceptor's process starts."""
        process = self.world.process(*arguments)
        module = process.load(self.package, "interceptor")
        process.spun(lambda: module.Node().run(["interceptor.py"]))
        return process

    # What was said

    @property
    def stops(self) -> list[bool]:
        """All requests."""
        return self.world.values("/gwendolen_control")

    @property
    def stop(self) -> bool:
        """The last request."""
        return self.stops[-1]

    @property
    def wheels(self) -> float:
        """What the wheels were told last, m/s."""
        told: list[float] = self.world.values("/cmd_vel_filtered", "linear.x")
        return told[-1] if told else 0.0

    @property
    def news(self) -> list[dict[str, Any]]:
        """All lines of verdicts."""
        return [json.loads(each) for each in self.world.values("/r1_monitor/verdicts")]

    @property
    def diagnostics(self) -> dict[str, Any]:
        """The last status of each name."""
        array = self.world.sent["/diagnostics"][-1][1]
        return {status.name: status for status in array.status}
