"""Payloads decoded: CDR, ROS 1, JSON, Protobuf."""
