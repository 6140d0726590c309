"""Comparisons that cannot be true together, decided by order alone.

Input is comparisons of one term with constants or with each other. Output is the combinations that
are impossible.
"""
