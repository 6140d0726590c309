"""The error for invalid stores."""

from __future__ import annotations

from fretish.diagnostics.diagnostic import Diagnostic


class StoreError(Exception):
    """A table of a store is invalid."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(diagnostic.message)
        self.diagnostic = diagnostic
