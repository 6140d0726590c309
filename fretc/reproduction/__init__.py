"""Evidence and proofs are made again, and compared with the project, the lock and a manifest."""
