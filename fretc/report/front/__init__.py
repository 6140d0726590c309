"""The first screen of the report: the decisive sentence, five figures, and groups of runs.

Input is the parts of the report. Output is the `Front` view.
"""
