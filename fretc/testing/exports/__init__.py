"""Exports of a suite: pytest files, tables, a self-test in C, and traces for FRET's simulator.

Input is a suite. Output is files.
"""
