"""Monitors in Rust: the check of their text, and the build as a shared library.

Input is the text of a monitor. Output is a machine that proofs step, or the reason of a refusal.
"""
