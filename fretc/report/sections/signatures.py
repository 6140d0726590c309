"""The signatures of the evidence, the proofs, the analysis, each review and each waiver."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.attestation import statement as attestation
from fretc.attestation.signatures import SignatureBook, SignatureState, Signing
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment, Inputs
from fretc.report.model.marks import sign_mark
from fretc.report.model.views import Signatures, SignatureView, Signed
from fretc.traceability.lock import Review
from fretc.traceability.waivers import Waiver
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_SIGNED = sign_mark("signed", signs.GOOD)
_UNSIGNED = sign_mark("unauthenticated", signs.OPEN)
BROKEN = sign_mark("does not verify", signs.BAD)


def of_review(book: SignatureBook, review: Review) -> SignatureView:
    """The signature of the reviewer."""
    return _view(_review(book, review))


def of_waiver(book: SignatureBook, waiver: Waiver) -> SignatureView:
    """The signature of the person who granted the waiver."""
    return _view(_waiver(book, waiver))


def _review(book: SignatureBook, review: Review) -> Signing:
    return book.of(attestation.review(review), review.reviewer)


def _waiver(book: SignatureBook, waiver: Waiver) -> Signing:
    return book.of(attestation.waiver(waiver), waiver.by)


def _view(signing: Signing) -> SignatureView:
    return SignatureView(_SIGNED if signing.is_good else _UNSIGNED, signing.text, signing.is_good)


def signatures(inputs: Inputs, assessments: Sequence[Assessment]) -> Signatures:
    """The table of signatures; those that do not verify come first."""
    book = inputs.book
    signers = book.signers.signers if book.signers else ()
    return Signatures(
        file=phrases.place(book.signers.file) if book.signers else "",
        signers=tuple(f"{', '.join(signer.principals)}: {signer.key.text}" for signer in signers),
        signed=(
            *_broken(book),
            *_files(inputs),
            *_people(book, assessments),
        ),
    )


def _broken(book: SignatureBook) -> Iterator[Signed]:
    for envelope in book.envelopes:
        for signer in envelope.broken:
            place = envelope.envelope.place
            where = f"{phrases.place(place.source.name)}:{place.line}"
            text = f"the signature is not by {signer.name}, or not about this item"
            yield Signed("signature", where, "", SignatureView(BROKEN, text, False))


def _files(inputs: Inputs) -> Iterator[Signed]:
    """The signatures of files, which are signed under their base names."""
    for kind, file in (
        (attestation.EVIDENCE, inputs.evidence),
        (attestation.PROOFS, inputs.verification),
        (attestation.ANALYSIS, inputs.together),
    ):
        if file is not None:
            signing = inputs.book.of_file(kind, file.sha256)
            yield Signed(kind, phrases.place(file.file), "", _view(signing))


def _people(book: SignatureBook, assessments: Sequence[Assessment]) -> Iterator[Signed]:
    for assessment in assessments:
        review, waiver = assessment.review_status.review, assessment.waiver
        if review is not None:
            name = f"{assessment.id}, by {review.reviewer}"
            yield Signed("review", name, assessment.anchor, of_review(book, review))
        if waiver is not None:
            name = f"{assessment.id}, by {waiver.by}"
            yield Signed("waiver", name, assessment.anchor, of_waiver(book, waiver))


def idle_signatures(book: SignatureBook, assessments: Sequence[Assessment]) -> Iterator[Diagnostic]:
    """F559 for each review and waiver with an invalid signature."""
    for assessment in assessments:
        review, waiver = assessment.review_status.review, assessment.waiver
        if review is not None:
            yield from _idle(f"the review of {assessment.id}", _review(book, review))
        if waiver is not None:
            yield from _idle(f"the waiver of {assessment.id}", _waiver(book, waiver))


def _idle(what: str, signing: Signing) -> Iterator[Diagnostic]:
    if signing.state in (SignatureState.ANOTHER, SignatureState.UNKNOWN, SignatureState.CHANGED):
        yield diagnostic("unauthenticated", what=what, signing=signing.text)
