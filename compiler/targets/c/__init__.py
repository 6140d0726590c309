"""C99 for controllers."""
