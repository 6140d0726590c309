"""Storage of logs: files, URLs, folders, object stores and bags.

Input is a path or an address. Output is a seekable stream, the messages of a bag, and the name of
the log for outputs.
"""
