"""The audit: monitors are run over logs, on one machine or many.

Input is a `Project` and the paths of logs. Output is verdicts with their evidence, in memory or in
a store.
"""
