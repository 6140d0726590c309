"""The proofs in the report, and which of them are results of a planned method."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ALL, PROVERS, ClaimResult, Proof
from compiler.targets.interceptor_options import ASSUMED
from fretc.report.model import phrases
from fretc.report.model.marks import Mark, sign_mark
from fretc.report.model.views import ProofView, RequirementView
from fretc.traceability.artefacts import Product, compiled_monitor
from fretc.verification.layers.table import OF_MONITOR
from fretc.verification.text_output import SIGNS

_MARKS: Mapping[str, Mark] = {
    str(result): sign_mark(str(result), sign) for result, sign in SIGNS.items()
}
"""Result → mark, worst first."""
SHARED = ("interceptor", "agent")
"""Names used as requirement of claims about shared parts."""


def proof_views(
    proofs: Iterable[Proof],
    products: Iterable[Product],
    requirement: FormalizedRequirement | None = None,
    joint: Collection[str] = (),
) -> tuple[ProofView, ...]:
    """The view of each proof.

    Args:
        proofs: proofs about one requirement, or about shared parts.
        products: the files that targets generate now; a proof about another file is suspect.
        requirement: the requirement; None if it cannot be read, and for shared parts.
        joint: SHA-256 of the joint monitors that would be generated now.
    """
    now = {product.file: product.sha256 for product in products if product.sha256}
    return tuple(_view(proof, now, requirement, joint) for proof in proofs)


def _view(
    proof: Proof,
    now: Mapping[str, str],
    requirement: FormalizedRequirement | None,
    joint: Collection[str],
) -> ProofView:
    suspicions = tuple(_suspicions(proof, now, requirement, joint))
    return ProofView(
        requirement=proof.requirement,
        layer=str(proof.layer),
        claim=proof.claim,
        mark=replace(_MARKS[proof.result], suspect=bool(suspicions)),
        detail=proof.detail,
        assumptions=proof.assumptions,
        engine=proof.engine,
        artefacts=tuple(sorted(proof.artefacts.items())),
        suspicions=suspicions,
    )


def _suspicions(
    proof: Proof,
    now: Mapping[str, str],
    requirement: FormalizedRequirement | None,
    joint: Collection[str],
) -> Iterator[str]:
    """Why a proof is about outdated files; only files that fretc generates are compared."""
    for name, examined in proof.artefacts.items():
        if name in now and now[name] != examined:
            what = "has changed" if name == ASSUMED else "would be generated differently now"
            yield f"{name} {what}"
    is_joint = any(examined in joint for examined in proof.artefacts.values())
    if proof.layer in OF_MONITOR and not (is_joint or _is_of_monitor(proof, now, requirement)):
        yield "it is about another monitor than the one generated now"


def _is_of_monitor(
    proof: Proof, now: Mapping[str, str], requirement: FormalizedRequirement | None
) -> bool:
    """Whether the proof is about the monitor that is generated now, in any language."""
    monitors = {hash_ for name, hash_ in now.items() if name.endswith("_monitor.py")}
    return any(
        examined in monitors
        or (requirement is not None and examined == compiled_monitor(requirement, name))
        for name, examined in proof.artefacts.items()
    )


def covering(method: str, proofs: Sequence[ProofView]) -> list[ProofView]:
    """The proofs that are results of a planned method."""
    if method in ALL:
        return list(proofs)
    if method in PROVERS:
        return [proof for proof in proofs if method in proof.engine.casefold()]
    return [proof for proof in proofs if proof.layer == method]


def worst(proofs: Iterable[ProofView]) -> ProofView:
    """The proof with the worst result; a suspect one comes first."""
    rank = list(_MARKS)
    return min(proofs, key=lambda proof: (rank.index(proof.mark.word), not proof.mark.suspect))


def in_words(proofs: Sequence[ProofView]) -> str:
    """`2 claims proved`; else the worst result with its reason."""
    decisive = worst(proofs)
    if is_proved(decisive):
        return f"{phrases.times(len(proofs), 'claim')} proved"
    why = decisive.suspicions[0] if decisive.suspicions else decisive.detail
    return f"{decisive.mark.text}: {decisive.claim} ({why})"


def is_proved(proof: ProofView) -> bool:
    """Whether the claim is proved and current."""
    return proof.mark.word == ClaimResult.PROVED and not proof.mark.suspect


def is_proved_layer(view: RequirementView, layer: str) -> bool:
    """Whether a layer has claims, and all of them are proved and current."""
    own = [proof for proof in view.proofs if proof.layer == layer]
    return bool(own) and all(map(is_proved, own))


def is_refuted(view: RequirementView) -> bool:
    """Whether verification has a counterexample, whatever the audited runs show."""
    return any(plan.refuted for plan in view.planned) or bool(refutations(view))


def refutations(view: RequirementView) -> tuple[ProofView, ...]:
    """The counterexamples of a requirement, including suspect ones."""
    return tuple(proof for proof in view.proofs if proof.mark.word == ClaimResult.COUNTEREXAMPLE)
