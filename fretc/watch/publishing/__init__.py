"""Publication of live verdicts for other programs: ROS diagnostics, and a Foxglove server.

Input is the state of a watch session. Output is messages.
"""
