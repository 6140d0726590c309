"""Measurements of one run: verdict, violations, margins, states, tallies, trials and situations.

Input is the columns of propositions and the outcome of a monitor. Output is values for the
evidence. Trials of many runs give confidence intervals.
"""
