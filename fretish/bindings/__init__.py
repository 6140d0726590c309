"""The meaning of `bindings.toml`: clock, signals, propositions, variables, units, interceptor.

Input is the text of the file. Output is `Declarations`, with all numbers exact, and the expressions
in it as trees.
"""
