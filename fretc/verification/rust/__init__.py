"""Monitors in Rust: the form of their text, and the library that rustc makes of it."""
