"""The truth of propositions from samples of signals, independent of any language.

Input is the policies and expressions of the bindings. Output is expressions that targets print
beside a monitor.
"""
