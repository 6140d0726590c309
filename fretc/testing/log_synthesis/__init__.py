"""Synthesis of logs: tests as logs of real messages, and as missions of the simulated robot.

Input is a suite and the bindings. Output is MCAP files whose audit gives the expected verdicts, and
scenarios.
"""
