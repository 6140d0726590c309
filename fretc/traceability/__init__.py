"""Traceability: fingerprints from hazard to review, the lock, changes since a review, waivers.

Input is project, evidence, `fretc.lock` and `waivers.toml`. Output is chains with suspect links,
changes, and warnings.
"""
