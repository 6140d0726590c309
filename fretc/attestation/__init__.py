"""Who vouches for what: keys, signatures, signed statements, and what fretc consists of."""
