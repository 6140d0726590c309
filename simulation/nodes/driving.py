"""The autonomous system and the operator beside it: they hear the robot and command it."""

import math
from typing import Any

from simulation.nodes import messages
from simulation.nodes.bus import Bus
from simulation.nodes.navigation import Navigator
from simulation.nodes.recovery import OperatorNode
from simulation.nodes.safety import outline_clearance
from simulation.world.lidar import Lidar, Points
from simulation.world.motion import STANDSTILL, BodyVelocity, Pose
from simulation.world.scenario import Scenario
from simulation.world.scene import ROBOT, Scene

PERIOD, PHASE = 100_000_000, 40_000_000
"""Nanoseconds: 10 Hz, 40 ms after the lidar; nobody synchronises them."""

COMMAND_LATENCY = 1_000_000
"""Nanoseconds from the control tick to the command."""

_SECOND = 10**9


class DriverNode:
    """Hears /odom, /scan and /gwendolen_control; says /cmd_vel, /goal and /manual_control."""

    def __init__(
        self, bus: Bus, scene: Scene, scenario: Scenario, lidar: Lidar, epoch: int
    ) -> None:
        self._bus, self._lidar, self._epoch = bus, lidar, epoch
        self._planner = scenario.planner
        self.navigator = Navigator(scene, scenario.planner)
        self._operator = OperatorNode(ROBOT) if scenario.operator.present else None
        self._estimate, self._velocity = scene.start, STANDSTILL
        self._points: Points | None = None
        self._clearance = math.nan
        self.measured = math.inf
        """The least clearance so far, metres."""
        self._stop = self._manual = False
        self._goal: Pose | None = None
        self._silent_until: int | None = None
        self.arrived_at: int | None = None
        """When the last goal was reached, nanoseconds; None: it is not."""
        bus.subscribe("/odom", self._hear_odometry)
        bus.subscribe("/scan", self._hear_scan)
        bus.subscribe("/gwendolen_control", self._hear_stop)
        bus.publish("/manual_control", messages.boolean(False), epoch)
        bus.every(PERIOD, epoch + PHASE, self._control)

    def _hear_odometry(self, message: Any, now: int) -> None:
        self._estimate, self._velocity = messages.motion(message)

    def _hear_scan(self, message: Any, now: int) -> None:
        ranges = message.ranges
        self._points = self._lidar.points(ranges)
        self._clearance = outline_clearance(ranges, self._lidar, ROBOT)
        if self._clearance < self.measured:
            self.measured = self._clearance
        if self._clearance >= self._planner.silent_below:
            self._silent_until = None
        elif self._silent_until is None:
            self._silent_until = now + round(self._planner.silent * _SECOND)

    def _hear_stop(self, message: Any, now: int) -> None:
        self._stop = bool(message.data)

    def _control(self, now: int) -> None:
        command = self._command(now)
        silent = self._silent_until is not None and now < self._silent_until
        if self._manual or not silent:
            self._bus.publish("/cmd_vel", messages.twist(command), now + COMMAND_LATENCY)

    def _command(self, now: int) -> BodyVelocity:
        """From the operator while there is a manoeuvre, else from the planner."""
        manoeuvre = self._manoeuvre(now)
        if manoeuvre is not None and not self._manual:
            self._say_manual(True, now)
        if manoeuvre is None and self._manual:
            self._say_manual(False, now)
            if self._points is not None:
                self.navigator.replan(self._estimate, self._points)
        return self._navigate(now) if manoeuvre is None else manoeuvre

    def _manoeuvre(self, now: int) -> BodyVelocity | None:
        if self._operator is None or self._points is None:
            return None
        stopped = self._stop and not self._manual
        seconds = (now - self._epoch) / _SECOND
        return self._operator.step(seconds, stopped, self._velocity, self._points)

    def _say_manual(self, manual: bool, now: int) -> None:
        self._manual = manual
        self._bus.publish("/manual_control", messages.boolean(manual), now)

    def _navigate(self, now: int) -> BodyVelocity:
        """The planner's command; a goal that comes into force is published."""
        command = self.navigator.step(self._estimate, self._clearance)
        if self.navigator.goal != self._goal:
            self._goal = self.navigator.goal
            if self._goal is None:
                self.arrived_at = now
            else:
                self._bus.publish("/goal", messages.goal_pose(now, self._goal), now)
        return command
