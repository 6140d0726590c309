"""Tests on a stage: as logs of real messages, and as missions of the simulated robot."""
