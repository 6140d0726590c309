"""Help with bindings: drafts from a log, and a check of bindings against logs.

Input is logs and requirements. Output is a draft of `bindings.toml`, or how often each proposition
was true, false and unknown.
"""
