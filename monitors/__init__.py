"""The run time: operators with memory, recorded logs, propositions on a clock, audits, evidence."""
