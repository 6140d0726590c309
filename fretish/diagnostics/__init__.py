"""Source text with positions, diagnostics with codes, and how they are rendered."""
