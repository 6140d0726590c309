"""Audit results for other tools: JUnit, SARIF, tables, Foxglove."""
