"""Sources of live messages: ROS 1, ROS 2 (DDS, Zenoh), Foxglove servers, and growing logs.

Input is the words of the command line. Output is messages as bytes with their definitions, and
events.
"""
