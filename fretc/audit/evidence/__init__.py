"""Evidence: the results of an audit as values, as a file, and as summaries.

Input is the result of each requirement in each run. Output is an evidence `Document`, and what
reads it back.
"""
