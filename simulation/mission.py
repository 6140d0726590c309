"""One inspection mission from start to end, recorded.

Simulated time is a whole number of ticks of 20 ms. Within a tick the order is: measure, decide,
command, move. A command takes hold one physics step (2 ms) after its tick began, which is where
the messages' latencies below end.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from simulation import recording as log
from simulation.lidar import Lidar, Points
from simulation.motion import STANDSTILL, Pose, Velocity
from simulation.navigation import MARGIN, MAX_SPEED, Navigator, PoseError
from simulation.recovery import MANOEUVRE, STAND, Operator
from simulation.robot import PHYSICS_STEP, Robot
from simulation.safety import (
    SAFE_DISTANCE,
    Interceptor,
    SafetyFunction,
    TooClose,
    outline_clearance,
)
from simulation.scene import ROBOT, STORE, Scene

EPOCH = 1_700_000_000 * 10**9
"""Nanoseconds; the log's time at the start of each mission."""

TICK = 20_000_000
"""Nanoseconds; the period of /odom and /ground_truth, and of the wheels' controller."""

SCAN_LATENCY = 300_000
"""Nanoseconds from the measurement to the message on /scan."""

ANSWER_LATENCY = 1_200_000
"""Nanoseconds from the message on /scan to the safety function's answer."""

COMMAND_LATENCY = 1_000_000
"""Nanoseconds from the control tick to the planner's command."""

INTERCEPT_LATENCY = 200_000
"""Nanoseconds from what the interceptor hears to what it says."""

_SECOND = 10**9
_TICKS_PER_SECOND = _SECOND // TICK
_SCAN_EVERY, _SCAN_AT = 5, 0  # 10 Hz
_CONTROL_EVERY, _CONTROL_AT = 5, 2  # 10 Hz, 40 ms after the scan: nobody synchronises them.
_HEARTBEAT_EVERY, _HEARTBEAT_AT = 25, 13  # 2 Hz
_STEPS = round(TICK / _SECOND / PHYSICS_STEP)
_LINGER = 1 * _TICKS_PER_SECOND  # The log shows the robot standing at the last goal.


@dataclass(frozen=True, slots=True)
class Mission:
    """What happened, as the simulator knows it; the log has to show it by itself.

    Attributes:
        seed: of the noise of lidar and pose.
        duration: simulated seconds.
        goals_reached: how many, in order.
        goals_total: how many there were; all reached means that the mission is complete.
        stops: how often the safety function requested a stop.
        measured_clearance: least clearance that the safety function computed from a scan, metres.
        true_clearance: least true distance from chassis to obstacle, metres, negative in contact.
        contacts: how often the chassis began to touch an obstacle.
        messages: how many the log holds.
        path: the log.
    """

    seed: int
    duration: float
    goals_reached: int
    goals_total: int
    stops: int
    measured_clearance: float
    true_clearance: float
    contacts: int
    messages: int
    path: Path


def record(
    out: Path,
    seed: int = 1,
    max_seconds: float = 240.0,
    progress: Callable[[float], None] | None = None,
) -> Mission:
    """Run a mission and write its log to `out`, replacing what is there.

    Args:
        out: an .mcap file in a folder that exists.
        seed: not negative; the same seed gives the same messages on the same machine.
        max_seconds: simulated; a mission that takes longer is cut off and still recorded.
        progress: called once for every simulated second, with the seconds so far.

    Raises:
        OSError: `out` cannot be written. Whatever is raised, no half file stays behind.
    """
    with log.recording(out) as recording:
        run = _Run(STORE, seed, recording)
        ticks = round(max_seconds * _SECOND / TICK)
        while run.tick < ticks and not run.over:
            if progress and run.tick % _TICKS_PER_SECOND == 0:
                progress(run.tick / _TICKS_PER_SECOND)
            run.step()
        recording.finish("simulation", _options(seed, max_seconds))
        return run.mission(seed, out)


def _options(seed: int, max_seconds: float) -> dict[str, str]:
    """What made the log: names and values of the metadata record `simulation`."""
    return {
        "seed": str(seed),
        "max_seconds": str(max_seconds),
        "safe_distance": str(SAFE_DISTANCE),
        "max_speed": str(MAX_SPEED),
        "planner_margin": str(MARGIN),
        "stand_seconds": str(STAND),
        "manoeuvre_seconds": str(MANOEUVRE),
        "robot_length": str(ROBOT.length),
        "robot_width": str(ROBOT.width),
    }


class _Run:
    """A mission under way: the parts, wired by topics as on the robot."""

    def __init__(self, scene: Scene, seed: int, recording: log.Recording) -> None:
        self.tick = 0
        self._log = recording
        self._lidar = Lidar()
        self._robot = Robot(scene, self._lidar, seed)
        self._error = PoseError(seed)
        self._navigator = Navigator(scene)
        self._operator = Operator(ROBOT)
        self._safety = SafetyFunction(TooClose())
        self._interceptor = Interceptor()
        self._points: Points = self._lidar.points(self._robot.scan())
        self._wheels = STANDSTILL
        self._manoeuvring = False
        self._goal: Pose | None = None
        self._goals_total = len(scene.goals)
        self._arrived_at = 0
        self._stops = self._contacts = 0
        self._touching = False
        self._measured = self._true = float("inf")

    @property
    def over(self) -> bool:
        """The last goal is reached and the robot has stood there for a moment."""
        return self._navigator.goal is None and self.tick - self._arrived_at >= _LINGER

    @property
    def _now(self) -> int:
        return EPOCH + self.tick * TICK

    def step(self) -> None:
        """One tick."""
        before = self._wheels
        self._report_pose()
        if self.tick % _SCAN_EVERY == _SCAN_AT:
            self._watch()
        if self.tick % _CONTROL_EVERY == _CONTROL_AT:
            self._control()
        if self.tick % _HEARTBEAT_EVERY == _HEARTBEAT_AT:
            self._say_stop(self._now)
        self._robot.drive(before, 1)
        self._robot.drive(self._wheels, _STEPS - 1)
        self._error.step(TICK / _SECOND)
        self._judge()
        self.tick += 1

    def mission(self, seed: int, out: Path) -> Mission:
        """The summary so far."""
        return Mission(
            seed=seed,
            duration=self.tick / _TICKS_PER_SECOND,
            goals_reached=self._navigator.reached,
            goals_total=self._goals_total,
            stops=self._stops,
            measured_clearance=self._measured,
            true_clearance=self._true,
            contacts=self._contacts,
            messages=self._log.messages,
            path=out,
        )

    def _report_pose(self) -> None:
        pose, velocity, now = self._robot.pose, self._robot.velocity, self._now
        estimate = self._error.estimate(pose)
        self._log.write("/ground_truth", log.odometry(now, log.MAP, pose, velocity), now)
        self._log.write("/odom", log.odometry(now, log.ODOM, estimate, velocity), now)
        if self.tick % _SCAN_EVERY == _SCAN_AT:
            self._log.write("/tf", log.transforms(now, estimate), now)

    def _watch(self) -> None:
        """A scan, and the safety function's answer to it."""
        ranges = self._robot.scan()
        seen = self._now + SCAN_LATENCY
        self._log.write("/scan", log.laser_scan(self._now, ranges, self._lidar), seen)
        self._points = self._lidar.points(ranges)
        clearance = outline_clearance(ranges, self._lidar, ROBOT)
        self._measured = min(self._measured, clearance)
        was_stopped = self._safety.stop_requested
        if self._safety.step(clearance) and not was_stopped:
            self._stops += 1
            self._say_stop(seen + ANSWER_LATENCY)
            self._intercept(seen + ANSWER_LATENCY + INTERCEPT_LATENCY)

    def _control(self) -> None:
        """The control tick: operator or planner commands, the interceptor passes it on."""
        command = self._command()
        heard = self._now + COMMAND_LATENCY
        self._log.write("/cmd_vel", log.twist(command), heard)
        self._interceptor = self._interceptor.hear_command(command)
        self._intercept(heard + INTERCEPT_LATENCY)

    def _command(self) -> Velocity:
        """From the operator while there is a manoeuvre, else from the planner."""
        now, stopped = self.tick / _TICKS_PER_SECOND, self._safety.stop_requested
        manoeuvre = self._operator.step(now, stopped, self._robot.velocity, self._points)
        if manoeuvre is not None:
            if not self._manoeuvring:
                self._safety.release()
                self._say_stop(self._now)
            self._manoeuvring = True
            return manoeuvre
        if self._manoeuvring:
            self._safety.rearm()
            self._navigator.replan()
            self._manoeuvring = False
        return self._navigate()

    def _navigate(self) -> Velocity:
        """The planner's command; a goal that comes into force is published."""
        command = self._navigator.step(self._error.estimate(self._robot.pose))
        if self._navigator.goal != self._goal:
            self._goal, self._arrived_at = self._navigator.goal, self.tick
            if self._goal is not None:
                self._log.write("/goal", log.goal_pose(self._now, self._goal), self._now)
        return command

    def _say_stop(self, time: int) -> None:
        """On /gwendolen_control, and the interceptor hears it."""
        requested = self._safety.stop_requested
        self._log.write("/gwendolen_control", log.boolean(requested), time)
        self._interceptor = self._interceptor.hear_stop(requested)

    def _intercept(self, time: int) -> None:
        """On /cmd_vel_filtered, and the wheels hear it."""
        self._wheels = self._interceptor.output()
        self._log.write("/cmd_vel_filtered", log.twist(self._wheels), time)

    def _judge(self) -> None:
        """Keep the truth for the summary."""
        self._true = min(self._true, self._robot.clearance())
        touching = self._robot.touching()
        self._contacts += touching and not self._touching
        self._touching = touching
