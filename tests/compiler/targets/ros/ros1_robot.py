"""A robot on real ROS 1, which drives towards a wall; what the wheels hear moves it.

It runs under Debian's Python, with rospy alone. Standard input: `go LISTENERS` begins once so many
nodes hear its scan; `away` puts it far from the wall; `stuck` and `free`: its brakes; `blind` and
`sees`: its lidar; `clock SECONDS` lets it publish simulated time from there on. Each line is
answered by the clearance, the speed, and how many scans there were.
"""

import json
import math
import sys
import threading
import time

import rospy
from geometry_msgs.msg import Twist  # type: ignore[import-not-found]
from nav_msgs.msg import Odometry  # type: ignore[import-not-found]
from rosgraph_msgs.msg import Clock  # type: ignore[import-not-found]
from sensor_msgs.msg import LaserScan  # type: ignore[import-not-found]

BEAMS, PERIOD, FAR, SPEED = 720, 0.025, 1.2, 0.8


class Robot:
    """Its clearance, m, and its speed, m/s."""

    def __init__(self) -> None:
        self.clearance, self.speed, self.wanted, self.stuck = FAR, 0.0, 0.0, False
        self.count, self.blind = 0, False
        self.clocks: rospy.Publisher | None = None
        self.time = 0.0
        self.scans = rospy.Publisher("/scan", LaserScan, queue_size=10)
        self.odometry = rospy.Publisher("/odom", Odometry, queue_size=10)
        self.commands = rospy.Publisher("/cmd_vel", Twist, queue_size=10)
        rospy.Subscriber("/wheels", Twist, self.hear, queue_size=10)
        step = 2 * math.pi / BEAMS
        self.cosines = [math.cos(-math.pi + i * step) for i in range(BEAMS)]
        self.scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_min=0.02)
        self.scan.range_max = 30.0

    def hear(self, message: Twist) -> None:
        self.wanted = message.linear.x

    def ranges(self) -> list[float]:
        """A wall ahead, and nothing behind."""
        if self.blind:
            return [math.nan] * BEAMS
        return [self.clearance / c if c > 0.04 else math.inf for c in self.cosines]

    def run(self) -> None:
        """For ever: a planner that always wants to drive on, and the robot."""
        due = time.monotonic()
        while True:
            if self.clocks:
                self.time += PERIOD
                self.clocks.publish(rospy.Time.from_sec(self.time))
            if not self.stuck:
                self.speed = self.wanted
            self.clearance = max(0.03, self.clearance - self.speed * PERIOD)
            self.scan.header.stamp = rospy.get_rostime()
            self.scan.ranges = self.ranges()
            self.scans.publish(self.scan)
            odometry = Odometry()
            odometry.header.stamp = self.scan.header.stamp
            odometry.twist.twist.linear.x = self.speed
            self.odometry.publish(odometry)
            if self.count % 4 == 0:
                command = Twist()
                command.linear.x = SPEED
                self.commands.publish(command)
            self.count += 1
            due += PERIOD
            time.sleep(max(0.0, due - time.monotonic()))


def main() -> None:
    """Do what is asked."""
    rospy.init_node("robot", disable_signals=True)
    robot = Robot()
    for line in sys.stdin:
        asked, _, more = line.strip().partition(" ")
        if asked == "go":
            while robot.scans.get_num_connections() < int(more):
                time.sleep(0.005)
            while robot.odometry.get_num_connections() < int(more):
                time.sleep(0.005)
            threading.Thread(target=robot.run, daemon=True).start()
        elif asked == "away":
            robot.clearance = FAR
        elif asked in ("stuck", "free"):
            robot.stuck = asked == "stuck"
        elif asked in ("blind", "sees"):
            robot.blind = asked == "blind"
        elif asked == "clock":
            robot.time = float(more)
            robot.clocks = robot.clocks or rospy.Publisher("/clock", Clock, queue_size=10)
        print(json.dumps([robot.clearance, robot.speed, robot.count]), flush=True)


if __name__ == "__main__":
    main()
