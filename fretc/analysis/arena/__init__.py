"""Requirements as one machine over Boolean functions: letters, counters, states."""
