"""Recognition of common FRETish mistakes: wrong operators, misplaced parts, wrong precedence.

Input is a text that the parser refused. Output is a diagnostic, with a fix where one is known.
"""
