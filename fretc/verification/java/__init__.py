"""Monitors in Java: the check of their text, and the virtual machine that runs it.

Input is the text of a monitor. Output is a machine that proofs step, or the reason of a refusal.
"""
