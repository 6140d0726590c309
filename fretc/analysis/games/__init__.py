"""Fixpoints over an arena: who wins the game, which runs exist, and which sets conflict.

Input is an arena. Output is winners, minimal conflicts, and traces that show them.
"""
