"""Campaigns: many simulated missions, audited.

Input is scenarios and seeds. Output is a table of verdicts with intervals.
"""
