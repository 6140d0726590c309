"""The HTML page of the report: selection of details, the matrix, and the argument as a tree.

Input is a `Report` and the evidence behind it. Output is one HTML file.
"""
