"""The target JavaScript: a monitor as an ES module, and code from samples to its inputs.

Input is `FormalizedRequirement`s. Output is `.mjs` files as `Artifact`s.
"""
