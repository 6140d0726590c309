"""The FRETish language: parser, syntax tree, printer, and the meaning of a sentence in English.

Input is the text of a requirement file. Output is `RequirementEntry`s, a `Sentence`, or
diagnostics.
"""
