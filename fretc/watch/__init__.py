"""Live monitoring of a robot.

Input is messages as they arrive. Output is ticks, interim verdicts and diagnostics, on a screen or
as lines, and a recording whose audit gives the same verdicts.
"""
