"""The part of the report about requirement sets.

Input is the evidence of `fretc analyze`. Output is a view: whether the requirements can be
satisfied together, and pictures of conflicts.
"""
