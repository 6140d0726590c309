"""The commands: one module for each, and shared code for their options and output.

Input is the command line. Output is what is printed and written, and the exit status.
"""
