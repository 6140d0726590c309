"""The parts that hear and say messages."""
