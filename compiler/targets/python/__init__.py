"""The targets in Python: standalone monitors, and the interceptor node.

Input is `FormalizedRequirement`s and bindings. Output is Python files that need the standard
library only, as `Artifact`s.
"""
