"""The drive of a warehouse vehicle: a minute of numbers, words and truth values, by a timetable.

    python -m simulation.warehouse good.mcap
    python -m simulation.warehouse --planted bad.mcap

`requirements/agv/` judges it. Planted are 1.8 m/s after 25 s, a stop for a person at 30 s that
begins 1 s late, and a way to the dock that begins 6 s late, at 46 s.
"""

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simulation.nodes import messages as say
from simulation.recording import RecordedTopic, recording
from simulation.world.motion import BodyVelocity, Pose

TOPICS = (
    RecordedTopic("/odom", "nav_msgs/msg/Odometry"),
    RecordedTopic("/battery", "sensor_msgs/msg/BatteryState"),
    RecordedTopic("/mode", "std_msgs/msg/String"),
    RecordedTopic("/docked", "std_msgs/msg/Bool"),
    RecordedTopic("/estop", "std_msgs/msg/Bool"),
    RecordedTopic("/person", "std_msgs/msg/Float64"),
)
EPOCH = 1_700_000_000_000_000_000
STEP_MS, LENGTH_MS = 50, 65_000
PERIODS_MS = {
    "/odom": 50, "/battery": 500, "/mode": 200, "/docked": 100, "/estop": 100, "/person": 100,
}  # fmt: skip
ACCELERATION, BRAKING = 1.0, 4.0
"""Metres per second squared."""


@dataclass(frozen=True, slots=True)
class Timetable:
    """When things happen, in milliseconds."""

    hurry: float = 1.2
    """Metres per second between 25.0 s and 28.0 s."""
    notices_person: int = 30_000
    """One comes near at 30.0 s, and leaves at 33.0 s."""
    notices_battery: int = 40_600
    """It is below 20 % from 40.0 s on."""

    @property
    def docked(self) -> int:
        """The vehicle stands at the dock."""
        return self.notices_battery + 12_000


GOOD = Timetable()
PLANTED = Timetable(hurry=1.8, notices_person=31_000, notices_battery=46_600)


def _wanted(plan: Timetable, at: int) -> BodyVelocity:
    """What the planner asks for."""
    if at < 2_000 or 36_000 <= at < 38_000:  # it begins; somebody presses the button
        return BodyVelocity(0.0, 0.0)
    if plan.notices_person <= at < 33_500:
        return BodyVelocity(0.0, 0.0)
    if at >= plan.notices_battery - 500:  # it slows down before it says that it docks
        return BodyVelocity(0.25 if at < plan.docked - 500 else 0.0, 0.0)
    if 20_000 <= at < 24_500:
        return BodyVelocity(0.4, math.pi / 4 if at >= 20_500 else 0.0)
    return BodyVelocity(plan.hurry if 25_000 <= at < 28_000 else 1.2 if at < 36_000 else 0.8, 0.0)


def _moved(pose: Pose, velocity: BodyVelocity) -> Pose:
    way = velocity.forward * STEP_MS / 1000
    yaw = pose.yaw + velocity.turn * STEP_MS / 1000
    return Pose(pose.x + way * math.cos(yaw), pose.y + way * math.sin(yaw), yaw)


def _driven(before: BodyVelocity, wanted: BodyVelocity) -> BodyVelocity:
    """What the wheels make of it in a step."""
    least, most = -BRAKING * STEP_MS / 1000, ACCELERATION * STEP_MS / 1000
    change = min(max(wanted.forward - before.forward, least), most)
    return BodyVelocity(round(before.forward + change, 6), wanted.turn)


def _mode(plan: Timetable, at: int) -> str:
    if at < plan.notices_battery:
        return "drive" if at >= 2_000 else "idle"
    return "docking" if at < plan.docked + 500 else "charging"


def drive(plan: Timetable) -> Iterator[tuple[str, Any, int]]:
    """Topic, message and time (nanoseconds), in their order."""
    pose, velocity, charge = Pose(1.0, 0.0), BodyVelocity(0.0, 0.0), 0.2595
    for at in range(0, LENGTH_MS + 1, STEP_MS):
        time = EPOCH + at * 10**6
        velocity = _driven(velocity, _wanted(plan, at))
        pose = _moved(pose, velocity)
        charging = _mode(plan, at) == "charging"
        charge += (0.002 if charging else -0.0015) * STEP_MS / 1000
        near = 1.0 if 30_000 <= at < 33_000 else 6.0
        said = {
            "/odom": say.odometry(time, say.ODOM, pose, velocity),
            "/battery": say.battery(time, charge),
            "/mode": say.text(_mode(plan, at)),
            "/docked": say.boolean(at >= plan.docked),
            "/estop": say.boolean(36_000 <= at < 37_500),
            "/person": say.number(near),
        }
        yield from (
            (topic, message, time) for topic, message in said.items() if at % PERIODS_MS[topic] == 0
        )


def record(path: Path, plan: Timetable) -> None:
    """Write the log of a drive."""
    with recording(path, topics=TOPICS) as log:
        for topic, message, time in drive(plan):
            log.write(topic, message, time)
        log.finish("warehouse", {"planted": str(plan != GOOD).lower()})


def main(arguments: Sequence[str] | None = None) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m simulation.warehouse", description=__doc__)
    parser.add_argument("log", type=Path, help="the MCAP file to write")
    parser.add_argument("--planted", action="store_true", help="with three violations")
    options = parser.parse_args(arguments)
    record(options.log, PLANTED if options.planted else GOOD)


if __name__ == "__main__":
    main()
