"""Comparisons of numbers as letters of a game, exactly: linear arithmetic by z3."""
