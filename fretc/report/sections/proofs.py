"""What was proved of a requirement, as it is shown, and what that says of its planned methods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from compiler.logic.claims import ALL, PROVERS, Proof, Result
from compiler.project.interceptor_options import ASSUMED
from fretc.report.model import phrases
from fretc.report.model.views import Mark, ProofView, RequirementView, sign_mark
from fretc.report.traceability.artefacts import Product
from fretc.verification.layers.table import OF_MONITOR
from fretc.verification.text_output import SIGNS

_MARKS: Mapping[str, Mark] = {
    str(result): sign_mark(str(result), sign) for result, sign in SIGNS.items()
}
"""The worst first, as for verdicts."""
SHARED = ("interceptor", "agent")
"""Claims that are about no single requirement."""


def proof_views(proofs: Iterable[Proof], made: Iterable[Product]) -> tuple[ProofView, ...]:
    """Each proof as it is shown.

    Args:
        proofs: of one requirement, or of what all share.
        made: what the targets make now; a proof about another text is suspect.
    """
    now = {product.file: product.sha256 for product in made if product.sha256}
    return tuple(_view(proof, now) for proof in proofs)


def _view(proof: Proof, now: Mapping[str, str]) -> ProofView:
    suspicions = tuple(_suspicions(proof, now))
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


def _suspicions(proof: Proof, now: Mapping[str, str]) -> Iterator[str]:
    """Texts that are made otherwise now; what fretc does not make is told by its hash only."""
    for name, known in proof.artefacts.items():
        if name in now and now[name] != known:
            what = "is not what it was" if name == ASSUMED else "is not made like that any more"
            yield f"{name} {what}"
    monitors = {hashed for name, hashed in now.items() if name.endswith("_monitor.py")}
    if proof.layer in OF_MONITOR and not monitors & {*proof.artefacts.values()}:
        yield "it is about another monitor than the one that is made now"


def covering(method: str, proofs: Sequence[ProofView]) -> list[ProofView]:
    """The proofs that are results of a planned method."""
    if method in ALL:
        return list(proofs)
    if method in PROVERS:
        return [proof for proof in proofs if method in proof.engine.casefold()]
    return [proof for proof in proofs if proof.layer == method]


def worst(proofs: Iterable[ProofView]) -> ProofView:
    """The one that decides."""
    rank = list(_MARKS)
    return min(proofs, key=lambda proof: (rank.index(proof.mark.word), not proof.mark.suspect))


def in_words(proofs: Sequence[ProofView]) -> str:
    """`2 claims proved`; else what is in the way."""
    found = worst(proofs)
    if is_proved(found):
        return f"{phrases.times(len(proofs), 'claim')} proved"
    why = found.suspicions[0] if found.suspicions else found.detail
    return f"{found.mark.text}: {found.claim} ({why})"


def is_proved(proof: ProofView) -> bool:
    """Whether it is proved of what is there now."""
    return proof.mark.word == Result.PROVED and not proof.mark.suspect


def is_refuted(view: RequirementView) -> bool:
    """Whether verification found a run against it, whatever the audited ones show."""
    return any(plan.refuted for plan in view.planned) or bool(refutations(view))


def refutations(view: RequirementView) -> tuple[ProofView, ...]:
    """The counterexamples to it, suspect ones too."""
    return tuple(proof for proof in view.proofs if proof.mark.word == Result.COUNTEREXAMPLE)
