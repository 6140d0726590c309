"""The store: evidence of many runs as a folder of Parquet tables with a manifest.

Input is results, written part by part. Output is results and summaries, each table checked against
the manifest.
"""
