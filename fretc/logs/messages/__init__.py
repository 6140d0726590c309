"""Decoders of message payloads: CDR, ROS 1, JSON and Protobuf.

Input is payloads and the definitions of their types. Output is messages, or the numbers of wanted
fields for many messages at once.
"""
