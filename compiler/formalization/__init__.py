"""From a sentence to its formulas, its watch and its reference automaton."""
