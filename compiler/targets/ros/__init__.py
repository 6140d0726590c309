"""The targets for ROS: packages with monitors, the node around them, and the interceptor.

Input is all requirements and bindings of a project. Output is the files of a ROS 1 or ROS 2 package
as `Artifact`s.
"""
