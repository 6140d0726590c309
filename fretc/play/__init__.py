"""The page of `fretc play`, on which users edit a trace and see each verdict.

Input is requirements and traces to start from. Output is one HTML file.
"""
