"""The MCAP format: records, chunks, index and damage.

Input is the bytes of a file. Output is the messages of the wanted topics, and the damaged parts of
the file.
"""
