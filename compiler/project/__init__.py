"""A requirements folder as one value; import from FRET; formatting."""
