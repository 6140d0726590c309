"""What agents report in a log: beliefs, goals and actions."""
