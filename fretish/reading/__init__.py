"""Texts of strangers read within bounds: TOML, YAML, encodings, cost, depth."""
