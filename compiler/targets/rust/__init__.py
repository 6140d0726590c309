"""The target Rust: a `no_std` monitor crate, and a crate from typed samples to its inputs.

Input is `FormalizedRequirement`s. Output is the files of the crates as `Artifact`s.
"""
