"""The arena of a requirement set: one counter for each requirement, over Boolean functions.

Input is `FormalizedRequirement`s and the role of each variable. Output is states and transitions as
decision diagrams.
"""
