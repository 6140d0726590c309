"""The proofs of a project: each layer and prover of the table that is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from compiler.files import records
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Proof, Result
from compiler.project.project import Project
from compiler.targets.python import monitor
from fretc.verification.layers.request import Request
from fretc.verification.layers.table import TABLE
from fretish.diagnostics.diagnostic import Diagnostic


def prove(project: Project, request: Request) -> tuple[Proof, ...] | Diagnostic:
    """All proofs: requirement by requirement from the monitor outwards, then what all share.

    Args:
        project: the requirements and what their bindings declare.
        request: which layers, with which texts.

    Raises:
        NotAMonitorError: the given text is no generated monitor.
    """
    single, common = list[Proof](), list[Proof]()
    for method in TABLE:
        if request.names(method.name):
            part = _part(project) if method.needs_monitor else project
            results = method.prove(part.formalized, part, request)
            if isinstance(results, Diagnostic):
                return results
            (single if method.of_requirement else common).extend(results)
    places = {requirement.id: place for place, requirement in enumerate(project.formalized)}
    proofs = (*sorted(single, key=lambda each: places[each.requirement]), *common)
    return tuple(_open_where_demanded(each, project, request) for each in proofs)


def _open_where_demanded(proof: Proof, project: Project, request: Request) -> Proof:
    """A claim that does not apply, and that somebody demands or plans, is open: not checked."""
    by_id = {requirement.id: requirement.entry for requirement in project.formalized}
    shared = tuple(by_id.values())
    own = (by_id[proof.requirement],) if proof.requirement in by_id else shared
    if proof.result is not Result.NOT_APPLICABLE or not any(
        request.demands(proof.layer, entry) for entry in own
    ):
        return proof
    return records.replace(proof, result=Result.NOT_CHECKED)


def missing_prover(request: Request) -> Diagnostic | None:
    """Why a prover that is asked cannot answer."""
    if not request.names("frama-c"):
        return None
    from fretc.verification.layers.frama_c import refusal

    return refusal(request)


def refusals(project: Project, request: Request) -> Mapping[str, Diagnostic]:
    """The requirements that no monitor can be made of, where a layer steps one, and why.

    No proof of these layers is about them.
    """
    if not any(method.needs_monitor and request.names(method.name) for method in TABLE):
        return {}
    return _without_monitor(project.formalized)


def _without_monitor(requirements: Sequence[FormalizedRequirement]) -> Mapping[str, Diagnostic]:
    refused = ((requirement.id, monitor.refuse(requirement)) for requirement in requirements)
    return {id: why for id, why in refused if why is not None}


def _part(project: Project) -> Project:
    """The requirements that a monitor can be made of."""
    refused = _without_monitor(project.formalized)
    return replace(project, formalized=tuple(r for r in project.formalized if r.id not in refused))
