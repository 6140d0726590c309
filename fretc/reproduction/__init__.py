"""Evidence and proofs made again, and held against the project, the lock and a manifest."""
