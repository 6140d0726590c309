"""What is wrong with a store, while it is read."""

from __future__ import annotations

from fretish.diagnostics.diagnostic import Diagnostic


class StoreError(Exception):
    """A table of a store is not what it must be."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic
