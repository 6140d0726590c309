"""The words that each target language reserves.

Targets read these tables, so that no generated name is a reserved word.
"""
