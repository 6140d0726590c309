"""Layer BOUNDS: a response comes in time, for all latencies, losses and braking times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Proof
from compiler.project.project import Project
from fretc.verification.layers.request import Request, setup_of
from fretc.verification.loop.bounds import bounds_proofs


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """Two proofs for each requirement: the general bound, and the declared bound."""
    for requirement in requirements:
        request.progress(f"{requirement.id}: bounds")
        yield from bounds_proofs(
            requirement, setup_of(requirement, project, request), request.limits
        )
