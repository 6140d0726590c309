"""A program under test, driven by a tester whose inputs react to its outputs."""
