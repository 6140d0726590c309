"""Many simulated missions, audited."""
