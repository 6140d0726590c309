"""Monitors in C: check of the layout, build as a shared library, and analysis by Frama-C.

Input is the text of a monitor. Output is a machine that proofs step, or the reason of a refusal.
"""
