"""Monitors in other languages, compiled and compared with their sentences."""
