"""Selection of logs: those since a time, or a random sample.

Input is the named logs and the options of `fretc audit`. Output is the logs to audit, and a record
of the selection for the evidence.
"""
