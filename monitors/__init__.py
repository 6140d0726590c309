"""The run time of generated monitors, nodes and interceptors; it needs only the standard library.

Input is messages, or truth values at ticks. Output is verdicts, and whether the robot must stop.
`source_text` gives the source text that targets copy into generated files.
"""
