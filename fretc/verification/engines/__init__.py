"""Engines: external programs and long computations, each in a process with limits.

Input is a file or a call, and the limits. Output is an `Outcome`, or that it was not checked.
"""
