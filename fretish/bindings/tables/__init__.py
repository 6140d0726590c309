"""Readers of `bindings.toml`: one module for each kind of table, and `reader` for the whole file.

Input is TOML with positions. Output is `Declarations`, and a diagnostic for each error.
"""
