"""The traceability report: from each hazard to the verdicts of its requirements.

`make` reads project, evidence, proofs, lock and signatures, `assembly` builds a `Report` from them,
and `forms` writes it. Only current evidence can show that a requirement holds.
"""
