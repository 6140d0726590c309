"""How many small faults in the product the suite finds: `python -m tests.fault_injection`.

`drawing` draws faults from a seed, `selection` says which tests stand near a module, `trial` runs
them against one fault in a copy of the tree. Two files beside them are read: `known.toml` has wrong
answers that were once there, `equivalent.toml` drawn changes that change nothing, with the reason.

Tools of PyPI were looked at: mutmut (3.3) changes functions alone and runs the whole suite of a
project from its own copy, cosmic-ray (8.4) has no drawn sample, and neither chooses tests by what
imports a module. With 150 faults in 70 000 lines, the choice of lines and of tests is the work.
"""
