"""Files in and out: text files, templates, checked JSON, settings, and the identity of a build.

Input is paths and values. Output is texts, complete files on disk, or a diagnostic.
"""
