"""One inspection mission from start to end, recorded.

The parts are wired by topics and share nothing else. A command takes hold at the end of the physics
step (2 ms) within which it arrives.
"""

import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from simulation import __version__
from simulation.nodes import messages
from simulation.nodes.bus import Bus
from simulation.nodes.driving import DriverNode
from simulation.nodes.guarding import WARM_UP, Gate, SafetyFunctionNode
from simulation.nodes.navigation import RESOLUTION, PoseError
from simulation.nodes.safety import Agent, Decision, Interceptor, TooClose
from simulation.recording import AGENT_TRACE, TOPICS, Encoding, MissionRecording, recording
from simulation.world.lidar import Lidar
from simulation.world.motion import STANDSTILL, Pose
from simulation.world.robot import PHYSICS_STEP, Robot
from simulation.world.scenario import Scenario
from simulation.world.scene import STORE, Scene
from simulation.world.walking import WalkerPath

EPOCH = 1_700_000_000 * 10**9
"""Nanoseconds; the log's time at the start of each mission."""

TICK = 20_000_000
"""Nanoseconds; the period of /odom and /ground_truth."""

SCAN_LATENCY = 300_000
"""Nanoseconds from the measurement to the message on /scan."""

_SECOND = 10**9
_TICKS_PER_SECOND = _SECOND // TICK
_STEP = round(PHYSICS_STEP * _SECOND)
_STEPS = TICK // _STEP
_SCAN_PERIOD = 100_000_000
_LINGER = 1 * _SECOND  # The log shows the robot standing at the last goal.
_STANDING = 0.01  # m/s and rad/s; slower counts as standing.


@dataclass(frozen=True, slots=True)
class Stop:
    """One intervention of the safety function."""

    at: Pose
    """Where the robot was when the request arrived."""
    latency: float | None
    """Seconds until it stood; None: it was released before."""
    distance: float
    """Metres that it moved until then."""
    seconds: float
    """Simulated time of the request."""


@dataclass(frozen=True, slots=True)
class Contact:
    """The chassis begins to touch an obstacle."""

    at: Pose
    """Where the robot was."""
    seconds: float
    """Simulated time."""


@dataclass(frozen=True, slots=True)
class Mission:
    """What happened, as the simulator knows it; the log has to show it by itself.

    Attributes:
        scenario: of the mission.
        seed: of the noise of lidar and pose, and of what gets lost.
        duration: simulated seconds.
        goals_reached: how many, in order.
        goals_total: how many there were; all reached means that the mission is complete.
        stops: the interventions.
        measured_clearance: least clearance that a scan showed, metres.
        true_clearance: least true distance from chassis to obstacle, metres, negative in contact.
        touched: each time that the chassis began to touch an obstacle.
        messages: how many the log holds.
        track: where the robot really was, at every tenth of a second.
        scene: the room as it really was.
        path: the log.
        requests: each time that the safety function changed what it wants, in seconds, and whether
            that is a stop.
    """

    scenario: Scenario
    seed: int
    duration: float
    goals_reached: int
    goals_total: int
    stops: tuple[Stop, ...]
    measured_clearance: float
    true_clearance: float
    touched: tuple[Contact, ...]
    messages: int
    track: tuple[Pose, ...]
    scene: Scene
    path: Path
    requests: tuple[tuple[float, bool], ...] = ()

    @property
    def contacts(self) -> int:
        """How often it was touched."""
        return len(self.touched)


def record(
    out: Path,
    scenario: Scenario,
    interceptor: Interceptor,
    seed: int = 1,
    decision: Decision | None = None,
    encoding: Encoding = Encoding.ROS2,
    max_seconds: float | None = None,
    progress: Callable[[float], None] | None = None,
    versions: dict[str, str] | None = None,
    agent: Agent | None = None,
) -> Mission:
    """Run a mission and write its log to `out`, replacing what is there.

    Args:
        out: an .mcap file in a folder that exists.
        scenario: what is wrong in it.
        interceptor: makes what stands between commands and wheels.
        seed: not negative; the same seed gives the same messages on the same machine.
        decision: when to stop; if not given, the threshold of the scenario by hand.
        encoding: of the log's messages.
        max_seconds: simulated; a mission that takes longer is cut off and still recorded. If not
            given, what the scenario says.
        progress: called once for every simulated second, with the seconds so far.
        versions: more to say in the log of what made it.
        agent: decides instead of `decision`; the log has what it publishes.

    Raises:
        OSError: `out` cannot be written. Whatever is raised, no half file stays behind.
        ValueError: the scenario moves an obstacle that the store does not have.
    """
    limit = scenario.duration if max_seconds is None else max_seconds
    topics = TOPICS if agent is None else (*TOPICS, AGENT_TRACE)
    with recording(out, encoding, scenario.recorder, EPOCH, topics) as log:
        run = _MissionRun(scenario, interceptor, seed, log, decision, agent)
        ticks = round(limit * _SECOND / TICK)
        while run.tick < ticks and not run.over:
            if progress and run.tick % _TICKS_PER_SECOND == 0:
                progress(run.tick / _TICKS_PER_SECOND)
            run.step()
        log.finish("simulation", _about(scenario, seed, limit, versions or {}))
        return run.mission(out)


def _about(scenario: Scenario, seed: int, limit: float, versions: dict[str, str]) -> dict[str, str]:
    """What made the log: names and values of the metadata record `simulation`."""
    options = asdict(replace(scenario, transport=dict(scenario.transport)))
    return {
        "simulation": __version__,
        "scenario": scenario.name,
        "title": scenario.title,
        "seed": str(seed),
        "max_seconds": str(limit),
        "options": json.dumps(options, sort_keys=True),
        **versions,
    }


def really(scene: Scene, scenario: Scenario) -> Scene:
    """The room with its obstacles where they really stand.

    Raises:
        ValueError: the scenario moves an obstacle that is not there.
    """
    moved = dict(scenario.store.moved)
    unknown = sorted(moved.keys() - {obstacle.name for obstacle in scene.obstacles})
    if unknown:
        raise ValueError(f"the store has no obstacle `{unknown[0]}`")
    places = {o.name: moved.get(o.name, (o.x, o.y)) for o in scene.obstacles}
    obstacles = (replace(o, x=places[o.name][0], y=places[o.name][1]) for o in scene.obstacles)
    return replace(scene, obstacles=tuple(obstacles))


def possible(scenario: Scenario) -> None:
    """Whether its obstacles and topics exist.

    Raises:
        ValueError: one does not.
    """
    really(STORE, scenario)
    unknown = sorted(scenario.transport.keys() - {topic.name for topic in TOPICS})
    if unknown:
        raise ValueError(f"the robot has no topic `{unknown[0]}`")


class _MissionRun:
    """A mission under way: the parts, wired by topics as on the robot."""

    def __init__(
        self,
        scenario: Scenario,
        interceptor: Interceptor,
        seed: int,
        log: MissionRecording,
        decision: Decision | None,
        agent: Agent | None = None,
    ) -> None:
        self.tick = 0
        self._scenario, self._seed, self._log = scenario, seed, log
        sensor = scenario.lidar
        lidar = Lidar(range_min=sensor.range_min, loses_near=sensor.nearer == "lost")
        self._lidar, self._scene = lidar, really(STORE, scenario)
        self._walk = WalkerPath(scenario.store.walker) if scenario.store.walker else None
        walker = self._walk.obstacle if self._walk else None
        self._robot = Robot(self._scene, lidar, seed, walker)
        self._error = PoseError(seed)
        self._wheels = STANDSTILL
        self._bus = Bus(log.write, scenario.transport, seed, EPOCH + WARM_UP)
        self._bus.subscribe("/cmd_vel_filtered", self._hear_wheels)
        self._driver = DriverNode(self._bus, STORE, scenario, lidar, EPOCH)
        if scenario.safety.on:
            rule = agent or decision or TooClose(lidar, scenario.safety.threshold)
            SafetyFunctionNode(self._bus, rule, scenario.safety, EPOCH, agent)
        Gate(self._bus, interceptor, scenario.interceptor.period, EPOCH)
        self._judge = _Judge(self._robot)
        self._bus.subscribe("/gwendolen_control", self._judge.hear_stop)
        self._begin()

    def _begin(self) -> None:
        grid = self._driver.navigator.map
        for topic, message in (
            ("/map", messages.occupancy(EPOCH, grid, RESOLUTION)),
            ("/tf_static", messages.fixed_transforms(EPOCH)),
            ("/robot_description", messages.description()),
        ):
            self._bus.publish(topic, message, EPOCH)
        self._bus.every(TICK, EPOCH, self._report)
        self._bus.every(_SCAN_PERIOD, EPOCH, self._scan)

    @property
    def over(self) -> bool:
        """The last goal is reached and the robot has stood there for a moment."""
        arrived = self._driver.arrived_at
        return arrived is not None and self._now - arrived >= _LINGER

    @property
    def _now(self) -> int:
        return EPOCH + self.tick * TICK

    def step(self) -> None:
        """One tick: what the parts hear and say within it, and what the robot does meanwhile."""
        now, done = self._now, 0
        while self._bus.next < now + TICK:
            due = math.ceil((self._bus.next - now) / _STEP)
            self._drive(due - done)
            done = due
            self._bus.run()
        self._drive(_STEPS - done)
        self._error.step(TICK / _SECOND)
        if self._walk:
            self._robot.place_walker(*self._walk.step(self.tick * TICK / _SECOND, self._robot.pose))
        self._judge.step(self.tick)
        self.tick += 1

    def _drive(self, steps: int) -> None:
        if steps > 0:
            self._robot.drive(self._wheels, steps)

    def mission(self, out: Path) -> Mission:
        """The summary so far."""
        judge = self._judge
        return Mission(
            scenario=self._scenario,
            seed=self._seed,
            duration=self.tick / _TICKS_PER_SECOND,
            goals_reached=self._driver.navigator.reached,
            goals_total=len(STORE.goals),
            stops=tuple(judge.stops),
            measured_clearance=self._driver.measured,
            true_clearance=judge.clearance,
            touched=tuple(judge.touched),
            messages=self._log.messages,
            track=tuple(judge.track),
            scene=self._scene,
            path=out,
            requests=tuple(judge.requests),
        )

    def _hear_wheels(self, message: Any, now: int) -> None:
        self._wheels = messages.velocity(message)

    def _report(self, now: int) -> None:
        """What the robot knows of its motion, and the truth."""
        pose, velocity, publish = self._robot.pose, self._robot.velocity, self._bus.publish
        estimate = self._error.estimate(pose)
        publish("/ground_truth", messages.odometry(now, messages.MAP, pose, velocity), now)
        publish("/ground_truth/clearance", messages.number(self._judge.present), now)
        publish("/odom", messages.odometry(now, messages.ODOM, estimate, velocity), now)
        if (now - EPOCH) % _SCAN_PERIOD == 0:
            publish("/tf", messages.transforms(now, estimate), now)
            publish("/clock", messages.clock(now), now)

    def _scan(self, now: int) -> None:
        """A turn of the lidar, with the faults of the scenario."""
        ranges, sensor = self._robot.scan(), self._scenario.lidar
        seconds = (now - EPOCH) / _SECOND
        faults = [o.says for o in sensor.outages if o.at <= seconds < o.at + o.seconds]
        if sensor.nan_first:
            ranges[0] = np.nan
        if "nan" in faults:
            ranges[:] = np.nan
        if "nothing" not in faults:
            self._bus.publish(
                "/scan", messages.laser_scan(now, ranges, self._lidar), now + SCAN_LATENCY
            )


class _Judge:
    """Keeps the truth for the summary."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.present = self.clearance = robot.clearance()
        self.touched: list[Contact] = []
        self.stops: list[Stop] = []
        self.track: list[Pose] = []
        self.requests: list[tuple[float, bool]] = []
        self._touching = self._stop = False
        self._braking: tuple[int, Pose] | None = None

    def hear_stop(self, message: Any, now: int) -> None:
        """On /gwendolen_control."""
        requested = bool(message.data)
        if not self.requests or requested != self._stop:
            self.requests.append(((now - EPOCH) / _SECOND, requested))
        if requested and not self._stop:
            self._braking = now, self._robot.pose
        if not requested and self._braking:
            self._stopped(None)
        self._stop = requested

    def step(self, tick: int) -> None:
        """After each tick."""
        robot = self._robot
        self.present = robot.clearance()
        self.clearance = min(self.clearance, self.present)
        touching = robot.touching()
        if touching and not self._touching:
            self.touched.append(Contact(robot.pose, (tick + 1) / _TICKS_PER_SECOND))
        self._touching = touching
        if tick % 5 == 0:
            self.track.append(robot.pose)
        velocity = robot.velocity
        if self._braking and abs(velocity.forward) < _STANDING and abs(velocity.turn) < _STANDING:
            self._stopped(EPOCH + (tick + 1) * TICK)

    def _stopped(self, now: int | None) -> None:
        assert self._braking is not None
        began, at = self._braking
        here = self._robot.pose
        latency = None if now is None else (now - began) / _SECOND
        distance = math.dist((at.x, at.y), (here.x, here.y))
        self.stops.append(Stop(at, latency, distance, (began - EPOCH) / _SECOND))
        self._braking = None
