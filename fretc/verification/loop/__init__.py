"""Proofs about monitor, interceptor and environment in a closed loop.

Input is the texts of monitor and interceptor, and the assumptions of the bindings. Output is a
proof, or a replayed shortest run.
"""
