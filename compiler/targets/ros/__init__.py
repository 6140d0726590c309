"""Packages of ROS: a monitor, the node around it, and the interceptor."""
