"""Analysis of requirement sets: realizability, conflicts, redundancy, vacuity, consistency.

Input is the requirements of a component and its assumptions. Output is findings, with traces,
repairs and controllers.
"""
