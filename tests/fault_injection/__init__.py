"""How many small faults in the product the suite finds: `python -m tests.fault_injection`.

`drawing` draws faults from a seed, `known` reads those that are written down, `selection` says
which tests stand near a module, `trial` runs them on each fault in a copy of the tree, by
`first_failure`. `known.toml` has wrong answers that were once there, `equivalent.toml` drawn
changes that no test could find, with the reason.

Tools of PyPI were looked at: mutmut (3.3) changes functions alone and runs the whole suite of a
project from its own copy, cosmic-ray (8.4) has no drawn sample, and neither chooses tests by what
imports a module. With 150 faults in 110 000 lines, the choice of lines and of tests is the work.
"""
