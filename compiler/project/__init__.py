"""A requirements folder as one `Project`, and the tools that work on its files.

Input is `.fret` files, bindings, hazards, settings and parents. Output is a `Project` with all its
diagnostics, formatted or fixed files, and imports from FRET.
"""
