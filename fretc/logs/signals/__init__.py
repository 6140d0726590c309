"""Signals and propositions over a recording.

Input is decoded messages and the bindings. Output is samples, and one column of truth values for
each proposition on the declared clock.
"""
