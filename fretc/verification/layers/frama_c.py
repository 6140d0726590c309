"""Prover Frama-C: a monitor in C has no undefined behaviour, for all inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof, not_checked, proof
from compiler.project.project import Project
from compiler.targets.c.monitor import TARGET
from fretc.verification.c.analysis import analysed
from fretc.verification.compiled.plan import SourceText
from fretc.verification.engines import frama_c
from fretc.verification.layers.request import Request
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

CLAIM = "the C code has no undefined behaviour, and each counter stays in its range"


def refusal(request: Request) -> Diagnostic | None:
    """F908 if Frama-C is not installed, F907 for a monitor that is not in C."""
    if frama_c.program() is None:
        return diagnostic("no_frama_c")
    if request.monitor is not None and request.header is None:
        return diagnostic("frama_c_needs_c", monitor=request.monitor.name)
    return None


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """A proof for each requirement, about the given monitor or a generated one.

    Raises:
        NotAMonitorError: the given text contains no requirement.
    """
    refused, program = refusal(request), frama_c.program()
    if refused is not None or program is None:
        reason = refused.message if refused else ""
        return (_not_checked(requirement, reason) for requirement in requirements)
    return _proofs(requirements, project, request, program)


def _proofs(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request, program: str
) -> Iterator[Proof]:
    accepted = list[FormalizedRequirement]()
    for requirement in requirements:
        refused = TARGET.refuse(requirement)
        if refused is None:
            accepted.append(requirement)
        else:
            yield _not_checked(requirement, refused.message)
    machines = " and ".join(f"`{name}`" for name in frama_c.MACHINES)
    under = (f"C is that of the machines {machines} of Frama-C: an `int` has 16 or 32 bits",)
    for given, own in _given(accepted, request):
        request.progress(f"{given.name}: Frama-C")
        proofs = analysed(own, given, program, request.limits, project.formalized)
        for requirement, outcome, engine, artefacts in proofs:
            yield proof(requirement.id, Layer.MONITOR, CLAIM, outcome, engine, under, artefacts)


def _not_checked(requirement: FormalizedRequirement, reason: str) -> Proof:
    return proof(requirement.id, Layer.MONITOR, CLAIM, not_checked(reason), frama_c.NAME)


def _given(
    requirements: Sequence[FormalizedRequirement], request: Request
) -> Iterator[tuple[SourceText, Sequence[FormalizedRequirement]]]:
    """The given monitor, or a generated one for each requirement; with its requirements."""
    if request.monitor is not None and request.header is not None:
        texts = (request.monitor, request.header)
        yield _named([(PurePath(each.name).name, each.text) for each in texts]), requirements
        return
    for requirement in requirements:
        monitor = TARGET.emit((requirement,))[
            :2
        ]  # The rest of the text computes inputs from samples.
        yield _named([(str(each.path), each.text) for each in monitor]), [requirement]


def _named(texts: Sequence[tuple[str, str]]) -> SourceText:
    """The file in C and its header, in this order."""
    (name, text), (header_name, header) = texts
    return SourceText(name, text, header_name, header)
