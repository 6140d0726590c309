"""Standalone Python: the monitor and the interceptor node."""
