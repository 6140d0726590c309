"""Layer AJPF: results of AJPF about an agent."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.project.project import Project
from fretc.verification.layers.request import Request, unknown


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """Proofs from AJPF's results; unchecked claims if only this layer is requested."""
    yield from request.ajpf
    if set(request.layers) == {Layer.AJPF}:
        known = {proof.requirement for proof in request.ajpf}
        for requirement in requirements:
            if requirement.id not in known:
                claim = f"AJPF: the agent of {requirement.id} keeps it"
                yield unknown(
                    requirement.id, Layer.AJPF, claim, "there is no result of AJPF (--ajpf)"
                )
