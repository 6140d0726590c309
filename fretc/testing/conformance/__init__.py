"""Conformance tests: a tester drives a program with inputs that react to its outputs.

Input is requirements and the command of the program. Output is which situations were reached, and
shrunk violations.
"""
