"""The program of a monitor: what it keeps and what it does at each tick, for any language."""
