"""The targets of `--emit`: one module or package for each kind of generated file.

Input is `FormalizedRequirement`s and `Options`. Output is `Artifact`s, or a diagnostic where the
target refuses.
"""
