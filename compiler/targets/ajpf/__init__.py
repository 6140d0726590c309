"""Targets for the AJPF model checker: property files, and bundles with agent and environment.

Input is `FormalizedRequirement`s. Output is `.psl` files and bundle folders as `Artifact`s.
"""
