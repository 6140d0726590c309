"""The terminal: shared options, output, progress and help of all commands.

Input is diagnostics and files to write. Output is text on the terminal, complete files, and the
exit status.
"""
