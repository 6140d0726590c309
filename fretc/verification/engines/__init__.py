"""Other programs and long computations, run with limits."""
