"""Who signed the evidence, the proofs, each review and each waiver, as it is shown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.attestation import statement as attestation
from fretc.attestation.signatures import Book, Signing, State
from fretc.attestation.statement import Subject
from fretc.audit.evidence.schema import Evidence
from fretc.report.model import phrases
from fretc.report.model.claims import Claim
from fretc.report.model.views import Signatures, SignatureView, Signed, sign_mark
from fretc.report.traceability.lock import Review
from fretc.report.traceability.waivers import Waiver
from fretc.verification.reader import Proofs
from fretish.diagnostics import signs
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity

_SIGNED = sign_mark("signed", signs.GOOD)
_UNSIGNED = sign_mark("unauthenticated", signs.OPEN)
BROKEN = sign_mark("does not verify", signs.BAD)


def of_review(book: Book, review: Review) -> SignatureView:
    """Whether a review is signed by its reviewer."""
    return _view(_review(book, review))


def of_waiver(book: Book, waiver: Waiver) -> SignatureView:
    """Whether a waiver is signed by whoever has granted it."""
    return _view(_waiver(book, waiver))


def _review(book: Book, review: Review) -> Signing:
    return book.of(attestation.review(review), review.reviewer)


def _waiver(book: Book, waiver: Waiver) -> Signing:
    return book.of(attestation.waiver(waiver), waiver.by)


def _view(found: Signing) -> SignatureView:
    return SignatureView(_SIGNED if found.is_good else _UNSIGNED, found.text, found.is_good)


def signatures(
    book: Book, claims: Sequence[Claim], evidence: Evidence | None, proofs: Proofs | None
) -> Signatures:
    """All that could be signed, who signed it, and whose keys count."""
    listed = book.signers.signers if book.signers else ()
    return Signatures(
        file=phrases.place(book.signers.file) if book.signers else "",
        signers=tuple(f"{', '.join(one.principals)}: {one.key.text}" for one in listed),
        signed=(*_broken(book), *_files(book, evidence, proofs), *_people(book, claims)),
    )


def _broken(book: Book) -> Iterator[Signed]:
    for one in book.envelopes:
        for signer in one.broken:
            place = one.envelope.place
            where = f"{phrases.place(place.source.name)}:{place.line}"
            said = f"it is not by {signer.name}, or not about this"
            yield Signed("signature", where, "", SignatureView(BROKEN, said, False))


def _files(book: Book, evidence: Evidence | None, proofs: Proofs | None) -> Iterator[Signed]:
    if evidence is not None:
        subject = Subject(attestation.EVIDENCE, phrases.place(evidence.file), evidence.sha256)
        yield _file(book, subject)
    if proofs is not None:
        yield _file(book, Subject(attestation.PROOFS, phrases.place(proofs.file), proofs.sha256))


def _file(book: Book, shown: Subject) -> Signed:
    """A file is signed under the last part of its name."""
    return Signed(shown.kind, shown.name, "", _view(book.of_file(shown.kind, shown.sha256)))


def _people(book: Book, claims: Sequence[Claim]) -> Iterator[Signed]:
    for claim in claims:
        review, waiver = claim.standing.review, claim.waiver
        if review is not None:
            name = f"{claim.id}, by {review.reviewer}"
            yield Signed("review", name, claim.anchor, of_review(book, review))
        if waiver is not None:
            name = f"{claim.id}, by {waiver.by}"
            yield Signed("waiver", name, claim.anchor, of_waiver(book, waiver))


def idle(book: Book, claims: Sequence[Claim]) -> Iterator[Diagnostic]:
    """F559 for each review and waiver with a signature that does not count."""
    for claim in claims:
        review, waiver = claim.standing.review, claim.waiver
        if review is not None:
            yield from _idle(f"the review of {claim.id}", _review(book, review))
        if waiver is not None:
            yield from _idle(f"the waiver of {claim.id}", _waiver(book, waiver))


def _idle(what: str, found: Signing) -> Iterator[Diagnostic]:
    if found.state in (State.ANOTHER, State.UNKNOWN, State.CHANGED):
        yield Diagnostic(
            Code.IDLE_SIGNATURE,
            f"{what} is unauthenticated: {found.text}",
            help="have its reviewer sign it: `fretc sign FILE --key KEY`; `allowed_signers` names "
            "whose keys count",
            severity=Severity.WARNING,
        )
