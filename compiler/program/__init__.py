"""The program of a monitor, independent of any language: typed cells and the steps of a tick.

Input is the monitor specifications of requirements. Output is a `Program`, which targets print.
"""
