"""Proofs that the text of a monitor in Python means what its sentence means.

Input is the text of a monitor and its requirement. Output is a proof, or a shortest trace that it
misjudges.
"""
