"""A suite as files: tests for pytest, tables for monitors, traces for FRET's simulator."""
