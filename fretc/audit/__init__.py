"""Monitors run over logs: the plan, one log, many logs, many machines."""
