"""The values of the report: assessments of requirements, and views of each part.

Input is project, evidence summaries, lock, waivers and proofs. Output is an `Assessment` for each
requirement; views are what templates and `--json` print.
"""
