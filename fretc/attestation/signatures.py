"""Signatures beside a file (`FILE.intoto.jsonl`), compared with the keys that count.

Each line is an envelope. Nothing in it counts before a signature of it verifies; what an envelope
says of itself (its payload, the name of its key) only explains why it does not count.

Source: in-toto Attestation Framework, Bundle, https://github.com/in-toto/attestation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from compiler.files.checked_json import SchemaError
from compiler.files.text_files import read as read_text
from fretc.attestation import statement as attestation
from fretc.attestation.statement import Statement, Subject
from fretc.attestation.statement import read as read_statement
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import unless_installed
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget

if TYPE_CHECKING:
    from fretc.attestation.keys import DsseEnvelope
    from fretc.attestation.signers import Signer, Signers
    from fretc.audit.evidence.result_summaries import EvidenceSource

SUFFIX = ".intoto.jsonl"
SIGNERS = "allowed_signers"
"""Whose keys count, in the folder of the requirements."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """A line of the file: a DSSE envelope, and the statement that is its payload."""

    dsse: DsseEnvelope
    statement: Statement
    place: Span

    @property
    def text(self) -> str:
        """The line."""
        return self.place.text


def beside(path: str) -> str:
    """Where the signatures of a file are."""
    return f"{path}{SUFFIX}"


def read(path: str) -> tuple[Envelope, ...] | Diagnostic:
    """The envelopes beside a file, none where there are no signatures; or what is wrong (F556)."""
    source = read_text(beside(path))
    if isinstance(source, Diagnostic):
        return () if source.code is Code.NO_SUCH_FILE else source
    return with_budget(len(source.text), source.span(), lambda: _envelopes(source))


def _envelopes(source: Source) -> tuple[Envelope, ...] | Diagnostic:
    from fretc.attestation.keys import read_envelope

    envelopes = []
    start = 0
    for line in source.text.split("\n"):
        place = source.span(start, start + len(line))
        start += len(line) + 1
        if not line.strip():
            continue
        try:
            dsse = read_envelope(line)
            envelopes.append(Envelope(dsse, read_statement(dsse.payload), place))
        except SchemaError as error:
            return _wrong(place, f"the line is no signed statement of fretc: {error}")
    return tuple(envelopes)


def envelope(line: str) -> Envelope:
    """The envelope of a new line."""
    from fretc.attestation.keys import read_envelope

    dsse = read_envelope(line)
    return Envelope(dsse, read_statement(dsse.payload), Source("", line).span())


def _wrong(place: Span, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_SIGNATURES,
        what,
        place.part(0, 0),
        help="take the file from your repository again, or remove it and sign anew: `fretc sign`",
    )


def appended(envelopes: Sequence[Envelope], new: Envelope, current: frozenset[Subject]) -> str:
    """The file with one envelope more.

    Args:
        envelopes: of the file. The new one replaces one of the same key about nothing else; one
            about nothing that is still there is left out.
        new: one more.
        current: everything that can be signed now.
    """
    return "".join(f"{one.text}\n" for one in (*kept(envelopes, new, current), new))


def kept(
    envelopes: Sequence[Envelope], new: Envelope, current: frozenset[Subject]
) -> tuple[Envelope, ...]:
    """The envelopes that stay beside a new one."""
    return tuple(
        one
        for one in envelopes
        if (about := one.statement.main & current)
        and not (one.dsse.key_ids == new.dsse.key_ids and about <= new.statement.main)
    )


# Judging ---------------------------------------------------------------------------------------


class State(StrEnum):
    """What is known of who signed a thing."""

    SIGNED = "signed"
    ANOTHER = "signed by another"
    UNKNOWN = "signed with an unknown key"
    CHANGED = "changed since it was signed"
    NONE = "not signed"


@dataclass(frozen=True, slots=True)
class Signing:
    """Who signed a thing, in words."""

    state: State
    text: str

    @property
    def is_good(self) -> bool:
        """Whether the required signer has signed it."""
        return self.state is State.SIGNED


@dataclass(frozen=True, slots=True)
class _CheckedEnvelope:
    """An envelope, the signers of whom a signature verifies, and those of whom none does."""

    envelope: Envelope
    subjects: frozenset[Subject]
    by: tuple[Signer, ...]
    broken: tuple[Signer, ...]


@dataclass(frozen=True, slots=True)
class SignatureBook:
    """All signatures of a project, checked against the signers."""

    signers: Signers | None
    """None: there is no list, and no key counts."""
    envelopes: tuple[_CheckedEnvelope, ...] = ()

    def of(self, subject: Subject, name: str | None = None) -> Signing:
        """Who signed exactly this.

        Args:
            subject: what it is now.
            name: the required signer; None: any of the signers.
        """
        about = [one for one in self.envelopes if subject in one.subjects]
        return self._of(about, subject, name)

    def of_file(self, kind: str, sha256: str) -> Signing:
        """Who signed a file of this content, whatever it is called."""
        about = [one for one in self.envelopes if _has(one, kind, sha256)]
        return self._of(about, Subject(kind, "", sha256), None)

    def agreed(self, evidence: EvidenceSource) -> Signing:
        """Who signed evidence with a statement that says the same as the file."""
        now = attestation.evidence(evidence, None)
        agreeing = [one for one in self.envelopes if _agrees(one.envelope.statement, now)]
        signing = self.of_file(attestation.EVIDENCE, evidence.sha256)
        if not signing.is_good:
            return signing
        if not any(one.by for one in agreeing):
            return Signing(State.CHANGED, "the statement that was signed says something else")
        return SignatureBook(self.signers, tuple(agreeing)).of_file(
            attestation.EVIDENCE, evidence.sha256
        )

    def _of(self, about: Sequence[_CheckedEnvelope], subject: Subject, name: str | None) -> Signing:
        by = list(dict.fromkeys(signer for one in about for signer in one.by))
        good = [signer for signer in by if name is None or signer.goes_by(name)]
        if good:
            return Signing(State.SIGNED, f"signed by {_names(good)}")
        if by:
            return Signing(State.ANOTHER, f"signed by {_names(by)}, who is not {name}")
        if about:
            return Signing(State.UNKNOWN, self._unknown(about))
        before = [
            signer for one in self.envelopes if _has_another(one, subject) for signer in one.by
        ]
        if before:
            names = _names(dict.fromkeys(before))
            return Signing(State.CHANGED, f"{names} signed it before it was changed")
        return Signing(State.NONE, "nobody signed it")

    def _unknown(self, about: Sequence[_CheckedEnvelope]) -> str:
        keys = dict.fromkeys(key for one in about for key in one.envelope.dsse.key_ids)
        names = {signer.key.fingerprint for one in about for signer in one.broken}
        unknown_keys = ", ".join(key for key in keys if key not in names)
        if not unknown_keys:
            return "its signature does not verify"
        if self.signers is None:
            return f"there is a signature ({unknown_keys}), and no list of signers"
        return f"there is a signature with a key that is not among the signers ({unknown_keys})"

    def diagnostics(self) -> Iterator[Diagnostic]:
        """F557 for each signature that does not verify, and what is wrong with the signers."""
        yield from self.signers.remarks if self.signers else ()
        for one in self.envelopes:
            for signer in one.broken:
                yield _broken(one.envelope, signer)


def _agrees(signed: Statement, now: Statement) -> bool:
    """Whether a signed statement equals the present one, but for the proofs."""
    says = {**signed.says, "proofs": now.says["proofs"]}
    return signed.of(attestation.LOG) == now.of(attestation.LOG) and says == now.says


NO_SIGNATURES = SignatureBook(None)


def _has(one: _CheckedEnvelope, kind: str, sha256: str) -> bool:
    return any((each.kind, each.sha256) == (kind, sha256) for each in one.subjects)


def _has_another(one: _CheckedEnvelope, subject: Subject) -> bool:
    """Whether the envelope is about an earlier content of it; of a file, the kind is enough."""
    return any(
        each.kind == subject.kind and subject.name in ("", each.name) for each in one.subjects
    )


def _names(signers: Iterable[Signer]) -> str:
    return " and ".join(signer.name for signer in signers)


def _broken(envelope: Envelope, signer: Signer) -> Diagnostic:
    return Diagnostic(
        Code.BROKEN_SIGNATURE,
        f"the signature of {signer.name} does not verify: it, or what was signed, is not as it was",
        envelope.place.part(0, 0),
        help="ask the signer, and sign anew what is right; somebody may have forged this",
    )


def missing() -> Diagnostic | None:
    """F908, where what is needed for signatures is not installed."""
    return unless_installed("signatures need", ["securesystemslib", "cryptography"], "sign")


def read_signatures(files: Sequence[str], signers: str | None) -> SignatureBook | Diagnostic:
    """The signatures beside files, checked against a list of signers.

    Args:
        files: that may have been signed.
        signers: path of the list; None: there is none.
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
    """The signatures beside files, checked."""
    checked: list[_CheckedEnvelope] = []
    for path in files:
        envelopes = read(path)
        if isinstance(envelopes, Diagnostic):
            return envelopes
        checked.extend(_checked(one, signers.signers if signers else ()) for one in envelopes)
    return SignatureBook(signers, tuple(checked))


def _checked(envelope: Envelope, signers: Sequence[Signer]) -> _CheckedEnvelope:
    named = [one for one in signers if one.key.fingerprint in envelope.dsse.key_ids]
    good = tuple(one for one in named if envelope.dsse.is_signed_by(one.key))
    bad = tuple(one for one in named if one not in good)
    return _CheckedEnvelope(envelope, frozenset(envelope.statement.subjects), good, bad)
