"""Tests made from requirements: short runs, each with the verdict that it is to get, and why."""
