"""An endpoint of the rosbridge protocol, version 2, for simulated robots.

Source: ROSBRIDGE_PROTOCOL.md of rosbridge_suite.
"""
