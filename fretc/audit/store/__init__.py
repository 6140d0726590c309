"""Evidence of many runs: a folder of Parquet tables and a manifest."""
