"""The layers and provers of `fretc verify`: one module for each, and `table`, which lists them.

Input is requirements, project and request. Output is a `Proof` for each claim.
"""
