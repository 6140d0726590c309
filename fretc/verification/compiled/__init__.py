"""Proofs about monitors in languages other than Python.

Input is a monitor that was compiled or is run by an interpreter. Output is its comparison with the
reference and with the monitor in Python.
"""
