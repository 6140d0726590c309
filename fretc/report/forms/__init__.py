"""The forms of the report: a table of all, and a module for each that another tool reads."""
