"""The traceability report: from each hazard to the verdicts of its requirements.

`make` reads project, evidence, proofs, lock and signatures, `assembly` builds a `Report` of them,
and `forms` writes it. A requirement is shown to hold only where current evidence shows it.
"""
