"""MCAP as bytes: records, chunks, index, damage."""
