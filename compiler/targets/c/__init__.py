"""The target C: a freestanding C99 monitor, and code from typed samples to its inputs.

Input is `FormalizedRequirement`s. Output is C files as `Artifact`s.
"""
