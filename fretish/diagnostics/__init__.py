"""Diagnostics: positions in source texts, codes with explanations, fixes, and their rendering.

Input is what a check found, with its place. Output is text for people and JSON for programs.
"""
