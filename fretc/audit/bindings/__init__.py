"""Bindings drafted from logs, and checked against them."""
