"""Layer LOOP: monitor, interceptor and any environment together keep the requirement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Proof
from compiler.project.folder import Project
from fretc.verification.layers.request import Request, setup_of
from fretc.verification.loop.layer import loop


def prove(rules: Sequence[Formalized], project: Project, request: Request) -> Iterator[Proof]:
    """Two proofs for each rule: it is kept, and the stop is released."""
    for rule in rules:
        request.progress(f"{rule.id}: loop")
        yield from loop(rule, setup_of(rule, project, request), request.limits)
