"""All diagnostics of a project, as `fretc check` and the editor report them.

Input is a project and the files beside it. Output is a list of diagnostics.
"""
