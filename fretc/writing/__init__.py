"""The choice between readings of an English text: questions about short runs, and their answers.

`fretish.english` makes the readings.
"""
