"""What is drawn: plots over time, histograms, timelines."""
