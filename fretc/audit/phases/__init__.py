"""Phases of the tick grid: at which offsets of the grid a verdict holds.

Input is a `Recording` and its monitors. Output is ranges of phases, each with its verdict.
"""
