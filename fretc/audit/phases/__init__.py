"""For which phases of the ticks a verdict holds."""
