"""Monitors in JavaScript: the form of their text, and Node, which runs it."""
