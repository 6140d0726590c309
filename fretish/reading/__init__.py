"""Untrusted texts read within bounds: TOML, YAML, encodings, cost, depth."""
