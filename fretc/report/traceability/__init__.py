"""The chain of fingerprints from hazard to review, the lock of reviews, and the waivers."""
