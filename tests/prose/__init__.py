"""The words of the project: what its texts may not say, and how hard they are to read."""
