"""Targets that show the reference automaton of a requirement: HOA, DOT and SMV.

Input is `FormalizedRequirement`s. Output is one file for each as an `Artifact`.
"""
