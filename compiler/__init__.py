"""The compiler: sentences to formulas, formulas to files, evidence to reports, and the command."""

__version__ = "0.1.0"
