"""Trends between audits: what is newly violated, fixed, flaky, slower or gone.

Input is the evidence of several audits. Output is one value, shown as text, JSON or an HTML page.
"""
