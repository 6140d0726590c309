"""Explanations of a requirement: diagram, example traces, and reasons.

Input is a `FormalizedRequirement`. Output is values that `fretc explain` and the report display.
"""
