"""Coverage goals (situations) of a sentence, and mutants of it.

Input is a `FormalizedRequirement`. Output is formulas of the past that tests aim at and recorded
runs are searched for, and changed sentences.
"""
