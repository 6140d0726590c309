"""Layer AJPF: what AJPF itself says of an agent."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.project.project import Project
from fretc.verification.layers.request import Request, unknown


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """The results of AJPF; if nothing else is asked, requirements without one are not checked."""
    yield from request.ajpf
    if set(request.layers) == {Layer.AJPF}:
        known = {proof.requirement for proof in request.ajpf}
        for requirement in requirements:
            if requirement.id not in known:
                claim = f"AJPF: the agent of {requirement.id} keeps it"
                yield unknown(
                    requirement.id, Layer.AJPF, claim, "there is no result of AJPF (--ajpf)"
                )
