"""The pictures of the report: what they contain, and where each line goes."""
