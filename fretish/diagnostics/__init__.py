"""Diagnostics: positions in source texts, codes with explanations, fixes, and their rendering.

Input is the result of a check, with its span. Output is text for people and JSON for programs.
"""
