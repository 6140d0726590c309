"""Verdicts of a robot that runs, for other programs: diagnostics of ROS, a Foxglove server."""
