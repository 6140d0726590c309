"""The first screen of the report: headline, five figures, and groups of runs.

Input is the parts of the report. Output is the `Front` view.
"""
