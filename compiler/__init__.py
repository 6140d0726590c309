"""The compiler: sentences to formulas, formulas to files, evidence to reports, and the command."""
