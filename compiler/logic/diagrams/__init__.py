"""Decision diagrams: Boolean functions, and the two libraries that compute them.

Input and output are functions over numbered variables.
"""
