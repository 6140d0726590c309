"""The traceability report: from each hazard to the verdicts of its requirements.

`make` reads the files, `assembly` puts the report together, `forms` writes it. A requirement is
shown where current evidence shows that it holds.
"""
