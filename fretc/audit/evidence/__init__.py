"""The results of an audit, as values, as a file, and over many runs."""
