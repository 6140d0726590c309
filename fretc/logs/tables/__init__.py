"""Tables as logs: CSV, TSV, JSON lines, Parquet and Arrow; a row is a message, a column its time.

A table in the wide form has one topic, `/table`, with a field for each other column. One in the
long form (time, name, value) has a topic for each name, `/table/<name>`, with the field `value`.
"""
