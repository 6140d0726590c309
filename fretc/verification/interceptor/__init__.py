"""Proofs that the text of an interceptor satisfies its contracts.

Input is the file of an interceptor. Output is a proof for each contract, or a shortest run that
breaks it.
"""
