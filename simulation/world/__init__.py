"""The simulated world: the robot, its lidar, the room, and the faults of a scenario.

Input is velocity commands and a scenario. Output is the robot's motion and the scans.
"""
