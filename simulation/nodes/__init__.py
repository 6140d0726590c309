"""The nodes of the simulated system: planner, operator, safety function and interceptor.

Input and output are messages on the topics of a bus.
"""
