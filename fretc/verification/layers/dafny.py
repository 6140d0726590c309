"""Prover Dafny: it verifies the file of `--emit dafny`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.project.project import Project
from compiler.targets import dafny
from fretc.verification.engines.dafny import with_dafny
from fretc.verification.layers.request import Request, unknown


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """A proof for each claim of the file of each requirement."""
    for requirement in requirements:
        request.progress(f"{requirement.id}: Dafny")
        refused = dafny.TARGET.refuse(requirement)
        if refused is not None:
            claim = "Dafny verifies the file of the requirement"
            yield unknown(requirement.id, Layer.LOOP, claim, refused.message)
            continue
        declared, seconds = project.declarations, float(request.limits.seconds)
        yield from with_dafny(
            requirement, dafny.text(requirement, declared), declared, seconds=seconds
        )
