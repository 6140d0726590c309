"""The target Java: a monitor as a class, and a class from typed samples to its inputs.

Input is `FormalizedRequirement`s. Output is `.java` files as `Artifact`s.
"""
