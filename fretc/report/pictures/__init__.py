"""Pictures of results: timelines, histograms and scales.

Input is the results of a requirement. Output is their content, and a layout for the template.
"""
