"""Gwendolen agents and AJPF properties: strict readers, and a model checker for agents.

Input is the text of an agent and of its properties. Output is proofs, or a counterexample.
"""
