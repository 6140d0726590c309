"""What differs between operating systems: files, processes, and limits of time and memory.

Linux has everything. Each function says what is missing where. Other rooms import neither `fcntl`
nor `resource`, and ask no system for its name.
"""
