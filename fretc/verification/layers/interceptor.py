"""Layer INTERCEPTOR: the text of the interceptor satisfies its contracts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.files import records
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof, not_applicable
from compiler.project.project import Project
from compiler.targets.interceptor_options import options
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import CallLimits, NoResult
from fretc.verification.interceptor.contracts import contracts
from fretc.verification.interceptor.file import otherwise
from fretc.verification.layers.request import Request, interceptor_of, unexamined, unknown
from fretc.verification.loop.closed_loop import NamedText
from fretish.bindings.declarations import Interception

CLAIM = "the interceptor keeps its contracts"


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """A proof for each contract."""
    file = interceptor_of(project, request)
    declared = project.declarations.interceptor if project.declarations else None
    if file is None or declared is None:
        reason = "the bindings declare no interceptor (`[interceptor]`)"
        outcome = not_applicable(reason)
        yield unexamined("interceptor", Layer.INTERCEPTOR, CLAIM, outcome)
        return
    request.progress("interceptor: its contracts")
    yield from _contracts(file, declared, request.limits)


def _contracts(file: NamedText, declared: Interception, limits: CallLimits) -> Iterator[Proof]:
    """Contracts of the deployed module: any core, within the node that fretc writes."""
    deviation = otherwise(file.text, declared)
    proofs: NoResult | tuple[Proof, ...]
    if deviation is not None:
        proofs = NoResult(deviation)
    else:
        proofs = processes.confined(limits, contracts, file.text, options(declared))
    if isinstance(proofs, NoResult):
        yield unknown("interceptor", Layer.INTERCEPTOR, CLAIM, proofs.reason, file)
    else:
        artefacts = {file.name: sha256(file.text)}
        yield from (records.replace(proof, artefacts=artefacts) for proof in proofs)
