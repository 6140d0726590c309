"""Verdicts of a robot that runs: arrivals of messages → ticks → standings, screen and recording."""
