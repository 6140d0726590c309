"""The compiler: FRETish sentences become formulas, and formulas become files.

Input is requirement files and `bindings.toml`. Output is `FormalizedRequirement`s, explanations,
and the files of `--emit` as `Artifact`s. `emit` has the table of all targets.
"""
