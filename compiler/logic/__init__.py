"""Temporal formulas: tree, definition, evaluation, printing, and the interface to Spot.

Input is formulas over propositions. Output is values at ticks, texts in each notation, automata,
and proofs as values.
"""
