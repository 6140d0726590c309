"""Formalization: a sentence becomes formulas, a monitor specification and a reference automaton.

Input is a `Requirement` and `Declarations`. Output is a `FormalizedRequirement` or diagnostics.
"""
