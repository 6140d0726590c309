"""Tests from requirements: short runs, each with its expected verdict and the reason.

Input is `FormalizedRequirement`s. Output is a suite of tests, with the situations and mutants that
it covers.
"""
