"""The run time of generated monitors and interceptors; standard library only."""
