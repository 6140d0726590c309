"""Comparisons in sentences as formulas of z3, over exact numbers.

Input is the comparisons of a sentence. Output says whether numbers exist that make them true and
false as asked.
"""
