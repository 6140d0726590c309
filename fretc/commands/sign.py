"""`fretc sign`, and shared code for keys and required signatures."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.files.dates import today
from fretc.terminal.options import PATH, extras, path_option
from fretc.terminal.output import (
    EXIT_VIOLATION,
    fail,
    or_fail,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible
from fretish.diagnostics.source import Source
from fretish.reading.natural_order import natural

if TYPE_CHECKING:
    from fretc.attestation.keys import PrivateKey
    from fretc.attestation.statement import SignedItem, Statement
    from fretc.audit.evidence.result_summaries import EvidenceSource
    from fretc.traceability.lock import Review
    from fretc.traceability.waivers import Waiver
    from fretc.verification.reader import Proofs

PASSPHRASE = "FRETC_PASSPHRASE"
"""Environment variable with the passphrase of a key, for use without a terminal."""


@dataclass(frozen=True, slots=True)
class Signable:
    """A file to sign: its statement, and a summary in words."""

    path: str
    statement: Statement
    current: frozenset[SignedItem]
    """All subjects in the file that anybody can sign."""
    lines: tuple[str, ...]


@click.command(
    epilog=extras({"sign": "all of this"}),
)
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@path_option(
    "--key", required=True, metavar="FILE", help="Your private key, for example ~/.ssh/id_ed25519."
)
@click.option(
    "--reviewer",
    help="Sign the reviews or waivers of this person.  [default: yours according to "
    "allowed_signers beside FILE, or those of the only person named]",
)
@path_option(
    "--verification",
    help="Proofs, signed together with the evidence.  [default: build/verification.json, if it "
    "exists]",
)
def sign(files: tuple[str, ...], key: str, reviewer: str | None, verification: str | None) -> None:
    """Sign evidence, proofs, an analysis, reviews, waivers or a report with your SSH key.

    FILE is build/evidence.json, build/verification.json, build/analysis.json, fretc.lock,
    waivers.toml or a report. The command prints what it signs before it asks for your
    passphrase, or reads it from FRETC_PASSPHRASE. The signature is appended to
    FILE.intoto.jsonl (in-toto statement in a DSSE envelope). Signatures of other people stay.

    Example: fretc sign --key ~/.ssh/id_ed25519 build/evidence.json
    """
    installed()
    signables = [_signable(path, key, reviewer, verification) for path in dict.fromkeys(files)]
    for signable in signables:
        for line in signable.lines:
            print_status(visible(line))
    mine = private(key)
    outputs: dict[Path, str] = {}
    for signable in signables:
        outputs |= signed(signable, mine)
    write_outputs(outputs, [*files, key])
    print_status(f"signed with {mine.public.text}")


def installed() -> None:
    """Exit if the packages for signatures are not installed."""
    from fretc.attestation.signatures import missing

    absent = missing()
    if absent is not None:
        fail(absent)


def private(path: str) -> PrivateKey:
    """The private key in a file; asks for its passphrase if it has one."""
    from compiler.files.text_files import content, unreadable

    installed()
    from fretc.attestation.keys import UnusableKeyError, private_key
    from fretc.attestation.signers import bad_key

    try:
        return private_key(content(path), lambda: _passphrase(path))
    except OSError as error:
        fail(unreadable(path, error))
    except UnusableKeyError as error:
        fail(bad_key(path, error))


def _passphrase(path: str) -> str:
    known = os.environ.get(PASSPHRASE)
    if known is not None:
        return known
    if not sys.stdin.isatty():
        fail(
            diagnostic(
                "passphrase_without_terminal",
                Source(path, "").span(),
                path=path,
                passphrase=PASSPHRASE,
            )
        )
    asked: str = click.prompt(f"passphrase of {visible(path)}", hide_input=True, err=True)
    return asked


def signed(what: Signable, key: PrivateKey) -> dict[Path, str]:
    """The signature file with the new signature."""
    from fretc.attestation.keys import signed_envelope
    from fretc.attestation.signatures import appended, beside, envelope, kept, read
    from fretc.attestation.statement import text

    envelopes = or_fail(read(what.path))
    new = envelope(signed_envelope(text(what.statement), key))
    omissions = len(envelopes) - len(kept(envelopes, new, what.current))
    if omissions:
        noun = "earlier signature is" if omissions == 1 else "earlier signatures are"
        print_status(
            f"{omissions} {noun} removed: they are replaced by this signature, or sign content "
            "that is gone"
        )
    return {Path(beside(what.path)): appended(envelopes, new, what.current)}


# What is signed --------------------------------------------------------------------------------


def _signable(path: str, key: str, reviewer: str | None, verification: str | None) -> Signable:
    suffix = Path(path).suffix
    if os.path.isdir(path):
        return _json(path, verification)
    if reviewer is not None and suffix not in (".lock", ".toml"):
        fail(_usage(f"`{path}` is by no reviewer", "remove `--reviewer`"))
    if suffix not in (".lock", ".toml", ".json", *_REPORTS):
        fix = "name evidence (`.json`, or a store), a lock (`.lock`), waivers (`.toml`) or a report"
        fail(_usage(f"`{path}` is nothing that fretc signs", fix))
    match suffix:
        case ".lock":
            return _lock(path, key, reviewer)
        case ".toml":
            return _waivers(path, key, reviewer)
        case ".json":
            return _json(path, verification)
        case _:
            return _report(path)


_REPORTS = (".html", ".md", ".csv", ".xml", ".sarif", ".reqif", ".yaml")


def _usage(what: str, fix: str) -> Diagnostic:
    return Diagnostic(Code.BAD_USAGE, what, help=fix)


def _json(path: str, verification: str | None) -> Signable:
    """The statement of a JSON file: evidence, proofs, an analysis or a report."""
    from compiler.files.text_files import read as read_text
    from compiler.logic import claims as proved
    from fretc.analysis import evidence as analyzed
    from fretc.audit.store.anywhere import read
    from fretc.report.model.views import SCHEMA
    from fretc.verification.reader import default_path

    if not os.path.isdir(path):
        source = or_fail(read_text(path))
        schema = _schema(source)
        if schema == proved.SCHEMA:
            return _proved(path)
        if schema == analyzed.SCHEMA:
            return _analyzed(path)
        if schema == SCHEMA:
            return _report(path)
    audited = read(path)
    if isinstance(audited, Diagnostic):
        fail(_as_error(audited))
    file = verification or default_path()
    return _evidence(audited, _proofs(file) if file is not None else None)


def _schema(source: Source) -> object:
    """The schema that the file states; F503 if it is not JSON."""
    from compiler.files.checked_json import JsonValue, SchemaError, plain

    try:
        whole = JsonValue(plain(source.text))
        return whole.field("schema").value
    except SchemaError as error:
        fail(
            diagnostic(
                "not_signable", Source(source.name, "").span(), source=source.name, error=error
            )
        )


def _as_error(wrong: Diagnostic) -> Diagnostic:

    return replace(wrong, severity=Severity.ERROR)


def _evidence(audited: EvidenceSource, proofs: Proofs | None) -> Signable:
    from fretc.attestation import statement as attestation

    if not os.path.isdir(audited.file):
        _same_bytes(audited.file, audited.sha256)
    if next(audited.summaries(), None) is None:
        fail(_usage(f"`{audited.file}` contains no run", "audit a log: `fretc audit LOG...`"))
    statement = attestation.evidence(audited, proofs)
    lines = (*_summary_of_evidence(audited), *(_summary_of_proofs(proofs) if proofs else ()))
    return Signable(audited.file, statement, statement.main, lines)


def _summary_of_evidence(audited: EvidenceSource) -> Iterator[str]:
    from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN
    from fretc.audit.measurements.confidence_intervals import REFUTED
    from fretc.report.model.assessments import SingleAudit
    from monitors import kernel

    audits = [
        SingleAudit.of(summary, (), is_assumption=summary.verdict == ASSUMPTION_BROKEN)
        for _, summary in audited.summaries()
    ]
    counts = Counter(audit.verdict for audit in audits)
    totals = ", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items()))
    yield f"evidence {audited.file}: {totals}"
    for audit in audits:
        result = audit.result
        if audit.verdict == kernel.VIOLATED:
            yield f"  {result.requirement} is violated in {result.run}"
        if audit.verdict == ASSUMPTION_BROKEN:
            yield f"  the assumption {result.requirement} is broken in {result.run}"
        if not result.log:
            yield f"  the SHA-256 of {result.run} is unknown: the log itself is not signed"
    for one in audited.probabilities:
        if one.answer == REFUTED:
            yield f"  {one.requirement} is refuted over all runs"


def _proofs(path: str) -> Proofs:
    from fretc.verification.reader import read

    proofs = or_fail(read(path))
    _same_bytes(path, proofs.sha256)
    return proofs


def _proved(path: str) -> Signable:
    from fretc.attestation import statement as attestation

    proofs = _proofs(path)
    statement = attestation.proofs(proofs)
    return Signable(path, statement, statement.main, tuple(_summary_of_proofs(proofs)))


def _analyzed(path: str) -> Signable:
    from fretc.analysis.evidence import read
    from fretc.attestation import statement as attestation

    known = or_fail(read(path))
    _same_bytes(path, known.sha256)
    found = known.document.analysis
    lines = (
        f"analysis {path}: {found.verdict}",
        *(f"  conflict of {', '.join(each.requirements)}" for each in found.conflicts),
        *(f"  assumed {each.id}: {each.sentence}" for each in found.assumptions),
    )
    statement = attestation.analysis(known)
    return Signable(path, statement, statement.main, lines)


def _summary_of_proofs(proofs: Proofs) -> Iterator[str]:
    from compiler.logic.claims import ClaimResult

    counts = Counter(proof.result for proof in proofs.proofs)
    totals = ", ".join(f"{count} {result}" for result, count in sorted(counts.items()))
    yield f"proofs {proofs.file}: {totals or 'none'}"
    for proof in proofs.proofs:
        if proof.result is ClaimResult.COUNTEREXAMPLE:
            yield f"  {proof.requirement}, {proof.layer}: a counterexample to: {proof.claim}"


def _same_bytes(path: str, sha256: str) -> None:
    """Exit unless the bytes that were read have this SHA-256."""
    from compiler.files.text_files import file_sha256

    if file_sha256(path) != sha256:
        fail(diagnostic("not_same_bytes", Source(path, "").span(), path=path))


def _report(path: str) -> Signable:
    from compiler.files.text_files import file_sha256, unreadable
    from fretc.attestation import statement as attestation

    digest = file_sha256(path)
    if digest is None:
        fail(unreadable(path, FileNotFoundError()))
    statement = attestation.report(path, digest)
    return Signable(path, statement, statement.main, (f"report {path}",))


def _lock(path: str, key: str, reviewer: str | None) -> Signable:
    from fretc.traceability.lock import read

    lock = read(path)
    if isinstance(lock, Diagnostic):
        fail(_as_error(lock))
    names = _names(path, [review.reviewer for review in lock.reviews.values()], key, reviewer)
    mine = [review for review in lock.reviews.values() if review.reviewer in names]
    return of_reviews(path, mine, lock.reviews.values())


def of_reviews(path: str, mine: Iterable[Review], all_: Iterable[Review]) -> Signable:
    """The statement of some reviews of a lock."""
    from fretc.attestation import statement as attestation

    chosen = sorted(mine, key=lambda review: natural(review.requirement))
    return Signable(
        path,
        attestation.reviews(chosen),
        frozenset(map(attestation.review, all_)),
        tuple(
            f"review of {r.requirement} by {r.reviewer}, {r.date}: {r.verdict_summary}"
            for r in chosen
        ),
    )


def _waivers(path: str, key: str, reviewer: str | None) -> Signable:
    from fretc.attestation import statement as attestation
    from fretc.traceability.waivers import read

    waivers, wrong = read(path, None, today())
    if any(mutant.is_error for mutant in wrong):
        fail(*wrong)
    names = _names(path, [waiver.by for waiver in waivers.values()], key, reviewer)
    mine = [waiver for waiver in waivers.values() if waiver.by in names]
    return Signable(
        path,
        attestation.waivers(mine),
        frozenset(map(attestation.waiver, waivers.values())),
        tuple(map(_waiver_line, mine)),
    )


def _waiver_line(waiver: Waiver) -> str:
    until = f"until {waiver.expires}"
    return f"waiver of {waiver.requirement} by {waiver.by} {until}: covers {waiver.verdict}"


def _names(path: str, written: Sequence[str], key: str, reviewer: str | None) -> Sequence[str]:
    """Names of the people whose reviews or waivers are signed."""
    names = list(dict.fromkeys(written))
    authors = ", ".join(f"`{name}`" for name in names) or "nobody"
    if reviewer is not None:
        if reviewer not in names:
            fail(
                _usage(f"no review or waiver in `{path}` is by `{reviewer}`", f"it is by {authors}")
            )
        return [reviewer]
    mine = _by_key(path, names, key) if len(names) > 1 else names
    if not mine:
        what = f"`{path}` names several people, and it is not clear who signs: {authors}"
        fail(_usage(what, "add `--reviewer NAME`"))
    return mine


def _by_key(path: str, names: Sequence[str], key: str) -> Sequence[str]:
    """The names that the list of signers gives to the key."""
    from fretc.attestation.signatures import SIGNERS
    from fretc.attestation.signers import read

    place = Path(path).parent / SIGNERS
    public = Path(f"{key}.pub")
    if not place.exists() or not public.exists():
        return []
    signers, mine = read(str(place)), _public(str(public))
    if isinstance(signers, Diagnostic):
        fail(signers)
    own = [signer for signer in signers.signers if signer.key.fingerprint == mine]
    return [name for name in names if any(signer.goes_by(name) for signer in own)]


def _public(path: str) -> str:
    """Fingerprint of a public key."""
    from fretc.attestation.signers import trusted

    people = or_fail(trusted(path))
    return next((signer.key.fingerprint for signer in people.signers), "")


# What must be signed ---------------------------------------------------------------------------


def require(evidence: EvidenceSource, by: str, others: Mapping[str, str | None]) -> None:
    """Exit with status 1 unless a trusted key has signed exactly this evidence.

    Args:
        evidence: the evidence that was read.
        by: path of the trusted public key, or of a list of signers.
        others: kind of another file (`report`, `proofs`, `analysis`) → path; these must be signed
            too.
    """
    from compiler.files.text_files import file_sha256
    from fretc.attestation.signatures import book

    installed()
    from fretc.attestation.signers import trusted

    keys = or_fail(trusted(by))
    companions = {kind: path for kind, path in others.items() if path is not None}
    signatures = or_fail(book([evidence.file, *companions.values()], keys))
    mistakes = list(signatures.diagnostics())
    signature = signatures.agreed(evidence)
    if not signature.is_good:
        mistakes.append(_unsigned(evidence.file, by, signature.text))
    for kind, path in companions.items():
        one = signatures.of_file(kind, file_sha256(path) or "")
        if not one.is_good:
            mistakes.append(_unsigned(path, by, one.text))
    print_diagnostics(mistakes)
    if any(diagnostic.is_error for diagnostic in mistakes):
        raise SystemExit(EXIT_VIOLATION)
    print_status(visible(f"{evidence.file} is {signature.text}"))


def _unsigned(path: str, by: str, why: str) -> Diagnostic:
    """F558."""
    return diagnostic("not_signed", Source(path, "").span(), path=path, by=by, why=why)
