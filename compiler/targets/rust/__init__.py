"""Rust without a standard library."""
