"""The formats of the report: a table of all, and a module for each format of another tool.

Input is a `Report` with its project and evidence. Output is HTML, JSON, CSV, JUnit, SARIF,
Markdown, ReqIF or GSN.
"""
