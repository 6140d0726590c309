"""Monitors in C: the form of their text, and the library that a compiler makes of it."""
