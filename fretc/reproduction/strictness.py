"""Additional demands of `--strict`: signatures, and a manifest of all runs.

An unmet demand is a difference: without a signature, anyone may have written the evidence, and
without a manifest, nothing shows that its runs are the intended ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compiler.files.text_files import file_sha256
from fretc.attestation import statement
from fretc.attestation.signatures import SignatureBook
from fretc.audit.evidence.reader import EvidenceFile
from fretc.reproduction.completeness import ComparisonScope
from fretc.reproduction.outcome import FILE, Recheck, differs

SIGNATURES = "signatures"
"""Name that is used instead of the name of a run."""


def unmet_demands(
    evidence: EvidenceFile,
    scope: ComparisonScope,
    of_files: SignatureBook,
    of_reviews: SignatureBook,
    others: Mapping[str, str],
    *,
    is_listed: bool,
) -> Iterator[Recheck]:
    """A difference for each unmet demand.

    Args:
        evidence: the evidence.
        scope: the requirements in force, and their reviews.
        of_files: the signatures of the evidence and of other files.
        of_reviews: the signatures of reviews.
        others: kind of each other existing file (`report`, `proofs`, `analysis`) → its path.
        is_listed: whether there is a manifest; its entries are compared elsewhere.
    """
    if not is_listed:
        yield differs(FILE, "", "its runs are not listed in a `--manifest`")
    signing = of_files.agreed(evidence)
    if not signing.is_good:
        yield differs(SIGNATURES, "", f"the evidence is not signed: {signing.text}")
    reviews = scope.lock.reviews if scope.lock is not None else {}
    for id in scope.claimed:
        if id not in reviews:
            yield differs(SIGNATURES, id, "it is not reviewed: `fretc.lock` has no review of it")
            continue
        review = of_reviews.of(statement.review(reviews[id]), reviews[id].reviewer)
        if not review.is_good:
            yield differs(SIGNATURES, id, f"its review is not signed: {review.text}")
    for kind, path in others.items():
        one = of_files.of_file(kind, file_sha256(path) or "")
        if not one.is_good:
            yield differs(SIGNATURES, "", f"`{path}` ({kind}) is not signed: {one.text}")
