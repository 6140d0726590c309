"""Zenoh as a source: ROS 2 with rmw_zenoh.

Input is a locator. Output is messages as bytes with their definitions, and events.
"""
