"""Requirement sets: can they be kept together, which fight, which say nothing."""
