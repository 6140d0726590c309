"""What is measured of a run: margins, violations, tallies, trials and their chance."""
