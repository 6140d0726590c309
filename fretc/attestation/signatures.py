"""Signatures of a file (`FILE.intoto.jsonl`), checked against the trusted signers.

Each line is an envelope. Its content is used only after a signature verifies. The payload and key
name of an unverified envelope only serve to explain why it is rejected.

Source: in-toto Attestation Framework, Bundle, https://github.com/in-toto/attestation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from compiler.files.checked_json import SchemaError
from compiler.files.text_files import read as read_text
from fretc.attestation import statement as attestation
from fretc.attestation.statement import SignedItem, Statement
from fretc.attestation.statement import read as read_statement
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import unless_installed
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget

if TYPE_CHECKING:
    from fretc.attestation.keys import DsseEnvelope
    from fretc.attestation.signers import Signer, Signers
    from fretc.audit.evidence.result_summaries import EvidenceSource

SUFFIX = ".intoto.jsonl"
SIGNERS = "allowed_signers"
"""Name of the list of trusted signers, in the folder of the requirements."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """A line of the file: a DSSE envelope and the statement in its payload."""

    dsse: DsseEnvelope
    statement: Statement
    place: Span

    @property
    def text(self) -> str:
        """The envelope as a line of the file."""
        return self.place.text


def beside(path: str) -> str:
    """Path of the signatures of a file."""
    return f"{path}{SUFFIX}"


def read(path: str) -> tuple[Envelope, ...] | Diagnostic:
    """The envelopes of a file, empty if it is not signed; or F556."""
    source = read_text(beside(path))
    if isinstance(source, Diagnostic):
        return () if source.code is Code.NO_SUCH_FILE else source
    return with_budget(len(source.text), source.span(), lambda: _envelopes(source))


def _envelopes(source: Source) -> tuple[Envelope, ...] | Diagnostic:
    from fretc.attestation.keys import read_envelope

    envelopes = []
    start = 0
    for line in source.text.split("\n"):
        span = source.span(start, start + len(line))
        start += len(line) + 1
        if not line.strip():
            continue
        try:
            dsse = read_envelope(line)
            envelopes.append(Envelope(dsse, read_statement(dsse.payload), span))
        except SchemaError as error:
            return _wrong(span, f"the line is not a signed statement of fretc: {error}")
    return tuple(envelopes)


def envelope(line: str) -> Envelope:
    """The envelope in a new line."""
    from fretc.attestation.keys import read_envelope

    dsse = read_envelope(line)
    return Envelope(dsse, read_statement(dsse.payload), Source("", line).span())


def _wrong(span: Span, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_SIGNATURES,
        what,
        span.part(0, 0),
        help="restore the file from version control, or delete it and sign again: `fretc sign`",
    )


def appended(envelopes: Sequence[Envelope], new: Envelope, current: frozenset[SignedItem]) -> str:
    """The text of the signature file with a new envelope added.

    Args:
        envelopes: the present ones, without those that `kept` removes.
        new: the new envelope.
        current: all subjects that can be signed now.
    """
    return "".join(f"{item.text}\n" for item in (*kept(envelopes, new, current), new))


def kept(
    envelopes: Sequence[Envelope], new: Envelope, current: frozenset[SignedItem]
) -> tuple[Envelope, ...]:
    """The envelopes to keep when a new one is added.

    Removed are envelopes without a current subject, and envelopes of the same key whose current
    subjects the new envelope covers.
    """
    return tuple(
        entry
        for entry in envelopes
        if (about := entry.statement.main & current)
        and not (entry.dsse.key_ids == new.dsse.key_ids and about <= new.statement.main)
    )


# Judging ---------------------------------------------------------------------------------------


class SignatureState(StrEnum):
    """The state of the signature of an item."""

    SIGNED = "signed"
    ANOTHER = "signed by another"
    UNKNOWN = "signed with an unknown key"
    CHANGED = "changed since it was signed"
    NONE = "not signed"


@dataclass(frozen=True, slots=True)
class Signing:
    """The state of a signature, with an explanation."""

    state: SignatureState
    text: str

    @property
    def is_good(self) -> bool:
        """Whether the required signer has signed the item."""
        return self.state is SignatureState.SIGNED


@dataclass(frozen=True, slots=True)
class _CheckedEnvelope:
    """An envelope, its signers with a valid signature, and its signers with only invalid ones."""

    envelope: Envelope
    subjects: frozenset[SignedItem]
    by: tuple[Signer, ...]
    broken: tuple[Signer, ...]


@dataclass(frozen=True, slots=True)
class SignatureBook:
    """All signatures of a project, checked against the trusted signers."""

    signers: Signers | None
    """The trusted signers; None if there is no list, so that no signature is valid."""
    envelopes: tuple[_CheckedEnvelope, ...] = ()

    def of(self, subject: SignedItem, name: str | None = None) -> Signing:
        """The signature of a subject.

        Args:
            subject: the item with its present content.
            name: the required signer; None: any trusted signer.
        """
        about = [entry for entry in self.envelopes if subject in entry.subjects]
        return self._of(about, subject, name)

    def of_file(self, kind: str, sha256: str) -> Signing:
        """The signature of a file with this content, under any name."""
        about = [entry for entry in self.envelopes if _has(entry, kind, sha256)]
        return self._of(about, SignedItem(kind, "", sha256), None)

    def agreed(self, evidence: EvidenceSource) -> Signing:
        """The signature of evidence, only from statements that agree with the file."""
        now = attestation.evidence(evidence, None)
        agreeing = [entry for entry in self.envelopes if _agrees(entry.envelope.statement, now)]
        signing = self.of_file(attestation.EVIDENCE, evidence.sha256)
        if not signing.is_good:
            return signing
        if not any(entry.by for entry in agreeing):
            return Signing(
                SignatureState.CHANGED, "the signed statement differs from what the file contains"
            )
        return SignatureBook(self.signers, tuple(agreeing)).of_file(
            attestation.EVIDENCE, evidence.sha256
        )

    def _of(
        self, about: Sequence[_CheckedEnvelope], subject: SignedItem, name: str | None
    ) -> Signing:
        by = list(dict.fromkeys(signer for entry in about for signer in entry.by))
        good = [signer for signer in by if name is None or signer.goes_by(name)]
        if good:
            return Signing(SignatureState.SIGNED, f"signed by {_names(good)}")
        if by:
            return Signing(SignatureState.ANOTHER, f"signed by {_names(by)}, who is not {name}")
        if about:
            return Signing(SignatureState.UNKNOWN, self._unknown(about))
        before = [
            signer
            for entry in self.envelopes
            if _has_another(entry, subject)
            for signer in entry.by
        ]
        if before:
            names = _names(dict.fromkeys(before))
            return Signing(SignatureState.CHANGED, f"{names} signed it before it was changed")
        return Signing(SignatureState.NONE, "nobody signed it")

    def _unknown(self, about: Sequence[_CheckedEnvelope]) -> str:
        keys = dict.fromkeys(key for entry in about for key in entry.envelope.dsse.key_ids)
        names = {signer.key.fingerprint for entry in about for signer in entry.broken}
        unknown_keys = ", ".join(key for key in keys if key not in names)
        if not unknown_keys:
            return "its signature does not verify"
        if self.signers is None:
            return f"there is a signature ({unknown_keys}), but there is no list of signers"
        return f"there is a signature, but its key is not in the list of signers ({unknown_keys})"

    def diagnostics(self) -> Iterator[Diagnostic]:
        """F557 for each signature that does not verify, and diagnostics about the signers."""
        yield from self.signers.remarks if self.signers else ()
        for entry in self.envelopes:
            for signer in entry.broken:
                yield _broken(entry.envelope, signer)


def _agrees(signed: Statement, now: Statement) -> bool:
    """Whether a signed statement equals the present one, except for proofs."""
    says = {**signed.says, "proofs": now.says["proofs"]}
    return signed.of(attestation.LOG) == now.of(attestation.LOG) and says == now.says


NO_SIGNATURES = SignatureBook(None)


def _has(one: _CheckedEnvelope, kind: str, sha256: str) -> bool:
    return any((subject.kind, subject.sha256) == (kind, sha256) for subject in one.subjects)


def _has_another(one: _CheckedEnvelope, subject: SignedItem) -> bool:
    """Whether the envelope covers an earlier content of the subject (for a file: of its kind)."""
    return any(
        item.kind == subject.kind and subject.name in ("", item.name) for item in one.subjects
    )


def _names(signers: Iterable[Signer]) -> str:
    return " and ".join(signer.name for signer in signers)


def _broken(envelope: Envelope, signer: Signer) -> Diagnostic:
    return diagnostic("broken_signature", envelope.place.part(0, 0), signer=signer.name)


def missing() -> Diagnostic | None:
    """F908 if the libraries for signatures are not installed."""
    return unless_installed("signatures need", ["securesystemslib", "cryptography"], "sign")


def read_signatures(files: Sequence[str], signers: str | None) -> SignatureBook | Diagnostic:
    """The signatures of files, checked against a list of signers.

    Args:
        files: paths of files that may be signed.
        signers: path of the list; None if there is none.
    """
    if signers is None and not any(Path(beside(path)).exists() for path in files):
        return SignatureBook(None)
    absent = missing()
    if absent is not None:
        return absent
    from fretc.attestation.signers import read as read_signers

    listed = read_signers(signers) if signers is not None else None
    return listed if isinstance(listed, Diagnostic) else book(files, listed)


def book(files: Sequence[str], signers: Signers | None) -> SignatureBook | Diagnostic:
    """The signatures of files, checked against trusted signers."""
    checked: list[_CheckedEnvelope] = []
    for path in files:
        envelopes = read(path)
        if isinstance(envelopes, Diagnostic):
            return envelopes
        checked.extend(_checked(entry, signers.signers if signers else ()) for entry in envelopes)
    return SignatureBook(signers, tuple(checked))


def _checked(envelope: Envelope, signers: Sequence[Signer]) -> _CheckedEnvelope:
    named = [signer for signer in signers if signer.key.fingerprint in envelope.dsse.key_ids]
    good = tuple(path for path in named if envelope.dsse.is_signed_by(path.key))
    bad = tuple(path for path in named if path not in good)
    return _CheckedEnvelope(envelope, frozenset(envelope.statement.subjects), good, bad)
