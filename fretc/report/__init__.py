"""The traceability report."""
