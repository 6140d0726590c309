"""Statements to be signed: subjects with their SHA-256, and claims about them.

A statement about evidence names the evidence, its logs and proofs, and repeats their results. A
statement about reviews or waivers has one subject per review, so that adding a review does not
invalidate the signatures of the others.

Source: in-toto Attestation Framework, Statement v1, https://github.com/in-toto/attestation.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any

from compiler.files.build_id import __version__, build_id
from compiler.files.checked_json import JsonValue, SchemaError, plain
from compiler.files.records import UNSET
from compiler.files.shell_quoting import is_sha256
from compiler.logic.claims import Proof
from fretc.analysis.evidence import AnalyzedSet
from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummary
from fretc.audit.evidence.verdict_inputs import KINDS
from fretc.traceability.lock import Review
from fretc.traceability.waivers import Waiver
from fretc.verification.reader import Proofs
from fretish.classes.frozen import dataclass

TYPE = "https://in-toto.io/Statement/v1"
EVIDENCE, LOG, PROOFS, ANALYSIS, REVIEW, WAIVER, REPORT = (
    "evidence", "log", "proofs", "analysis", "review", "waiver", "report",
)  # fmt: skip
_KINDS = {
    EVIDENCE: (EVIDENCE, LOG, PROOFS),
    PROOFS: (PROOFS,),
    ANALYSIS: (ANALYSIS,),
    REVIEW: (REVIEW,),
    WAIVER: (WAIVER,),
    REPORT: (REPORT,),
}
"""Topic of a statement → the kinds of subjects that it may have."""


@dataclass(frozen=True, slots=True)
class SignedItem:
    """A signed item; its kind is signed too, so that a log cannot pass for evidence."""

    kind: str
    name: str
    sha256: str

    @property
    def label(self) -> str:
        """`review:R1`."""
        return f"{self.kind}:{self.name}"


@dataclass(frozen=True, slots=True)
class Statement:
    """The content of a signature."""

    about: str
    """The topic: one of the kinds."""
    subjects: tuple[SignedItem, ...]
    says: Mapping[str, Any] = field(default_factory=dict)
    """Results of the subjects that the statement repeats."""

    @property
    def main(self) -> frozenset[SignedItem]:
        """The subjects of the topic, without the logs and proofs of evidence."""
        return self.of(self.about)

    def of(self, kind: str) -> frozenset[SignedItem]:
        """The subjects of one kind."""
        return frozenset(subject for subject in self.subjects if subject.kind == kind)


def text(statement: Statement) -> bytes:
    """The statement as JSON, with the version of fretc."""
    return json.dumps(
        {
            "_type": TYPE,
            "subject": [
                {"name": subject.label, "digest": {"sha256": subject.sha256}}
                for subject in statement.subjects
            ],
            "predicateType": _uri(statement.about),
            "predicate": {**statement.says, "tool": _tool()},
        }
    ).encode()


def _tool() -> dict[str, str]:
    python = platform.python_version()
    return {"fretc": __version__, "edition": build_id(), "python": python}


def _uri(about: str) -> str:
    return f"urn:fretc:{about}:1"


def read(payload: bytes) -> Statement:
    """The statement in a JSON text.

    Raises:
        SchemaError: the text is not a statement of fretc.
    """
    try:
        shape = JsonValue(plain(payload.decode()))
    except UnicodeDecodeError:
        raise SchemaError("the payload is not UTF-8 text") from None
    shape.only("_type", "subject", "predicateType", "predicate")
    shape.field("_type").one_of((TYPE,))
    uri = shape.field("predicateType").one_of(tuple(map(_uri, _KINDS)))
    about = next(kind for kind in _KINDS if _uri(kind) == uri)
    subjects = tuple(_subject(each, about) for each in shape.field("subject").items())
    predicate = shape.field("predicate").fields()
    says = {key: each.value for key, each in predicate.items() if key != "tool"}
    return Statement(about, subjects, says)


def _subject(at: JsonValue, about: str) -> SignedItem:
    at.only("name", "digest")
    at.field("digest").only("sha256")
    kind, colon, name = at.field("name").text().partition(":")
    digest = at.field("digest").field("sha256")
    if not colon or kind not in _KINDS[about]:
        raise at.field("name").wrong(f"the name of something that is signed as `{about}`")
    if not is_sha256(digest.text()):
        raise digest.wrong("a SHA-256")
    return SignedItem(kind, name, digest.text())


# What is signed --------------------------------------------------------------------------------


def evidence(file: EvidenceSource, proofs: Proofs | None) -> Statement:
    """The statement about evidence and proofs."""
    summaries = [summary for _, summary in file.summaries()]
    logs = dict.fromkeys(
        SignedItem(LOG, result.run, result.log) for result in summaries if result.log
    )
    return Statement(
        EVIDENCE,
        (
            SignedItem(EVIDENCE, Path(file.file).name, file.sha256),
            *logs,
            *([_proofs(proofs)] if proofs else []),
        ),
        {
            "fretc": file.fretc,
            "requirements": _requirements(summaries),
            "probabilities": [
                [probability.requirement, probability.answer] for probability in file.probabilities
            ],
            "proofs": _proved(proofs.proofs) if proofs else [],
        },
    )


def _requirements(results: Sequence[ResultSummary]) -> list[dict[str, Any]]:
    """Requirement → the inputs of its verdicts, and the verdicts."""
    verdicts_of: dict[str, dict[str, Any]] = {}
    for result in results:
        recorded = zip(KINDS, result.rests_on, strict=True)
        rests_on = {kind: known for kind, known in recorded if known is not UNSET}
        key = json.dumps([result.requirement, rests_on], sort_keys=True)
        one = {"id": result.requirement, "rests_on": rests_on, "verdicts": []}
        verdicts_of.setdefault(key, one)["verdicts"].append([result.run, result.verdict])
    return [*verdicts_of.values()]


def proofs(file: Proofs) -> Statement:
    """The statement about a file of proofs."""
    return Statement(PROOFS, (_proofs(file),), {"proofs": _proved(file.proofs)})


def analysis(file: AnalyzedSet) -> Statement:
    """The statement about an analysis of requirements."""
    content = file.document.analysis
    says = {
        "requirements": {id: each.sha256 for id, each in file.document.requirements.items()},
        "verdict": content.verdict,
        "conflicts": [list(conflict.requirements) for conflict in content.conflicts],
        "assumptions": {assumption.id: assumption.sentence for assumption in content.assumptions},
    }
    return Statement(ANALYSIS, (SignedItem(ANALYSIS, Path(file.file).name, file.sha256),), says)


def _proofs(file: Proofs) -> SignedItem:
    return SignedItem(PROOFS, Path(file.file).name, file.sha256)


def _proved(proofs: Sequence[Proof]) -> list[dict[str, Any]]:
    return [
        {
            "requirement": proof.requirement,
            "layer": str(proof.layer),
            "claim": proof.claim,
            "result": proof.result,
            "artefacts": dict(proof.artefacts),
        }
        for proof in proofs
    ]


def reviews(all_reviews: Iterable[Review]) -> Statement:
    """The statement about reviews; the hash of a review is its seal."""
    return Statement(REVIEW, tuple(map(review, all_reviews)))


def review(one: Review) -> SignedItem:
    """The subject of one review."""
    return SignedItem(REVIEW, one.requirement, one.seal)


def waivers(all_waivers: Iterable[Waiver]) -> Statement:
    """The statement about waivers."""
    return Statement(WAIVER, tuple(map(waiver, all_waivers)))


def waiver(one: Waiver) -> SignedItem:
    """The subject of one waiver."""
    return SignedItem(WAIVER, one.requirement, one.seal)


def report(path: str, sha256: str) -> Statement:
    """The statement about a report in any format."""
    return Statement(REPORT, (SignedItem(REPORT, Path(path).name, sha256),))
