"""Rules for common errors in FRETish: wrong operators, misplaced parts, unclear precedence.

Input is a text that the parser refused. Output is a diagnostic, with a fix if there is one.
"""
