"""Readers of untrusted text with limits: TOML, YAML, encodings, CPU time, memory, nesting depth.

Input is text from outside. Output is values with positions, or a diagnostic.
"""
