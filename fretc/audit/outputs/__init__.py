"""Results of an audit for people and other tools: JUnit, SARIF, tables, SQL queries, Foxglove.

Input is evidence. Output is texts, Parquet tables and annotation logs.
"""
