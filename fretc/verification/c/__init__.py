"""Monitors in C: the check of their text, the build as a shared library, and Frama-C's driver.

Input is the text of a monitor. Output is a machine that proofs step, or the reason of a refusal.
"""
