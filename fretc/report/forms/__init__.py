"""The report for other tools."""
