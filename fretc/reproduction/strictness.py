"""What `--strict` demands beside the comparison: signatures, and a manifest of all runs.

What is demanded and missing is a difference: evidence that anybody may have written, or of runs
that nobody lists, is not shown to be the one that somebody stands for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compiler.files.text_files import file_sha256
from fretc.attestation import statement
from fretc.attestation.signatures import SignatureBook
from fretc.audit.evidence.reader import EvidenceFile
from fretc.reproduction.completeness import Scope
from fretc.reproduction.outcome import FILE, Recheck, differs

SIGNATURES = "signatures"
"""In the place of a run."""


def unmet_demands(
    evidence: EvidenceFile,
    scope: Scope,
    of_files: SignatureBook,
    of_reviews: SignatureBook,
    others: Mapping[str, str],
    *,
    is_listed: bool,
) -> Iterator[Recheck]:
    """Each demand that is not met.

    Args:
        evidence: as it was read.
        scope: the requirements in force, and their reviews.
        of_files: the signatures of the evidence and of the other files.
        of_reviews: those of the reviews.
        others: kind of each other file that there is (`report`, `proofs`, `analysis`) → its path.
        is_listed: whether there is a manifest; that it names each run is compared elsewhere.
    """
    if not is_listed:
        yield differs(FILE, "", "no `--manifest` lists its runs")
    signing = of_files.agreed(evidence)
    if not signing.is_good:
        yield differs(SIGNATURES, "", f"the evidence is not signed: {signing.text}")
    reviews = scope.lock.reviews if scope.lock is not None else {}
    for id in scope.claimed:
        if id not in reviews:
            yield differs(SIGNATURES, id, "nobody has reviewed it: `fretc.lock` has no review")
            continue
        review = of_reviews.of(statement.review(reviews[id]), reviews[id].reviewer)
        if not review.is_good:
            yield differs(SIGNATURES, id, f"its review is not signed: {review.text}")
    for kind, path in others.items():
        one = of_files.of_file(kind, file_sha256(path) or "")
        if not one.is_good:
            yield differs(SIGNATURES, "", f"`{path}` ({kind}) is not signed: {one.text}")
