"""Recorded logs: files, URLs and bags become a Recording."""
