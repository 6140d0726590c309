"""Strategies as machines: what a system may do to keep its requirements, as files."""
