"""Controllers: winning strategies of the system as machines.

Input is a game that the system wins. Output is a controller in Python, or a Mealy machine in HOA or
DOT.
"""
