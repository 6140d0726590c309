"""Coverage: which situations recorded runs have shown, and which mutants they would detect.

Input is evidence, or logs for mutants. Output is coverage of each requirement, and the fewest runs
that suffice.
"""
