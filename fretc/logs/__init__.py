"""Recorded logs: MCAP files, ROS bags and URLs.

Input is the path of a log and the signals that are wanted. Output is a `Recording`: samples of the
signals, and the health of the log.
"""
