"""The page to play with a trace: what it starts from, and how it is made."""
