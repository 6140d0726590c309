"""Reproduction: evidence, proofs and analyses are computed again and compared.

Input is files that fretc wrote, project, lock and manifest. Output: for each item whether it is
reproduced, differs or was not checked.
"""
