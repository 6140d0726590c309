"""Layer LOOP of `fretc verify`: monitor, interceptor and any environment satisfy the requirement.

`fretc.verification.loop` proves it, one requirement after the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Proof
from compiler.project.project import Project
from fretc.verification.layers.request import Request, setup_of
from fretc.verification.loop.closed_loop import loop_proofs


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """Two proofs for each requirement: it is satisfied, and a stop is finally released."""
    for requirement in requirements:
        request.progress(f"{requirement.id}: loop")
        setup = setup_of(requirement, project, request)
        yield from loop_proofs(requirement, setup, request.limits)
