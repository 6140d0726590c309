"""All runs in one picture."""
