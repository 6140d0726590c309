"""From requirements in plain English to FRETish, by rules.

A text has several readings; each is a sentence. No word is dropped without being named.
"""
