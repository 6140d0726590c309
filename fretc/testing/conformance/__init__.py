"""Conformance tests: a tester drives a program with inputs that react to its outputs.

Input is requirements and the command of the program. Output is the reached situations, and
minimized violations.
"""
