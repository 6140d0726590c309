"""The code that generated monitors, nodes and interceptors carry with them; standard library only.

Input is messages or truth values at ticks. Output is verdicts, and whether the robot must stop.
`source_text` gives the text that targets copy.
"""
