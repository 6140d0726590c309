"""Temporal formulas: tree, definition, evaluation, printing, and Spot."""
