"""Monitors in JavaScript: the check of their text, and Node, which runs it.

Input is the text of a monitor. Output is a machine that proofs step, or the reason of a refusal.
"""
