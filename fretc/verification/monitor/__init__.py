"""Proofs that the text of a monitor in Python has the meaning of its sentence.

Input is the text of a monitor and its requirement. Output is a proof, or a shortest trace with a
wrong verdict.
"""
