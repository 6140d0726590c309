"""The sections of the report: each module makes the views of one part.

Input is assessments, runs and proofs. Output is views.
"""
