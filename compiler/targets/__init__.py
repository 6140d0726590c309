"""One module for each kind of file that `--emit` makes."""
