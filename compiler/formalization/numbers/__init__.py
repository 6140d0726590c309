"""What sentences say of numbers, exactly: comparisons as formulas of z3."""
