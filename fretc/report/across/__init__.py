"""Pictures of all runs together: a lane for each run, the used share of bounds, and maps.

Input is assessments and evidence. Output is views with their layout.
"""
