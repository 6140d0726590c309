"""What an audit has shown, as values, as a file, and over many runs."""
