"""The proofs of a project, by each requested layer and prover."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from compiler.files import records
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimResult, Proof
from compiler.project.project import Project
from compiler.targets.python import monitor
from fretc.verification.layers.request import Request
from fretc.verification.layers.table import TABLE
from fretish.diagnostics.diagnostic import Diagnostic


def prove(project: Project, request: Request) -> tuple[Proof, ...] | Diagnostic:
    """All proofs: requirement by requirement from the monitor outwards, then the shared ones.

    Args:
        project: the requirements and the bindings.
        request: layers, provers and texts.

    Raises:
        NotAMonitorError: the given text is not a generated monitor.
    """
    single, common = list[Proof](), list[Proof]()
    for method in TABLE:
        if request.names(method.name):
            part = _part(project) if method.needs_monitor else project
            results = method.prove(part.formalized, part, request)
            if isinstance(results, Diagnostic):
                return results
            (single if method.of_requirement else common).extend(results)
    places = {requirement.id: index for index, requirement in enumerate(project.formalized)}
    proofs = (*sorted(single, key=lambda each: places[each.requirement]), *common)
    return tuple(_open_where_demanded(proof, project, request) for proof in proofs)


def _open_where_demanded(proof: Proof, project: Project, request: Request) -> Proof:
    """A claim that does not apply counts as not checked if it was requested or planned."""
    by_id = {requirement.id: requirement.entry for requirement in project.formalized}
    shared = tuple(by_id.values())
    own = (by_id[proof.requirement],) if proof.requirement in by_id else shared
    if proof.result is not ClaimResult.NOT_APPLICABLE or not any(
        request.demands(proof.layer, entry) for entry in own
    ):
        return proof
    return records.replace(proof, result=ClaimResult.NOT_CHECKED)


def missing_prover(request: Request) -> Diagnostic | None:
    """The diagnostic of a requested prover that is not installed."""
    if not request.names("frama-c"):
        return None
    from fretc.verification.layers.frama_c import refusal

    return refusal(request)


def refusals(project: Project, request: Request) -> Mapping[str, Diagnostic]:
    """Requirements without a monitor, with the reasons, if a layer steps monitors.

    No proof of these layers is about them.
    """
    if not any(method.needs_monitor and request.names(method.name) for method in TABLE):
        return {}
    return _without_monitor(project.formalized)


def _without_monitor(requirements: Sequence[FormalizedRequirement]) -> Mapping[str, Diagnostic]:
    refused = ((requirement.id, monitor.refuse(requirement)) for requirement in requirements)
    return {id: why for id, why in refused if why is not None}


def _part(project: Project) -> Project:
    """The requirements that have a monitor."""
    refused = _without_monitor(project.formalized)
    return replace(project, formalized=tuple(r for r in project.formalized if r.id not in refused))
