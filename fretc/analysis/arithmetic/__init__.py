"""Comparisons of numbers as valuations in a game, exact by linear arithmetic in z3.

Input is the comparisons of requirements. Output is an alphabet for the arena: the truth patterns
that numbers can satisfy.
"""
