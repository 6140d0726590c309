"""Reproduction: evidence, proofs and analyses are computed again and compared.

Input is files that fretc wrote, project, lock and manifest. Output says of each item whether it
stands, differs or was not checked.
"""
