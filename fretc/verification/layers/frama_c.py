"""Prover Frama-C: a monitor in C does nothing undefined, whatever its inputs are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof, proof
from compiler.project.folder import Project
from compiler.targets.c.monitor import TARGET
from fretc.verification.compiled.c_analysis import analysed
from fretc.verification.compiled.c_verifying import Given
from fretc.verification.engines import frama_c
from fretc.verification.layers.request import Request, unknown
from fretish.diagnostics.diagnostic import Code, Diagnostic

CLAIM = "the text in C does nothing that C leaves undefined, and each counter keeps its range"


def prove(
    rules: Sequence[Formalized], project: Project, request: Request
) -> list[Proof] | Diagnostic:
    """A proof for each rule: of the monitor that is given, else of the one that fretc writes."""
    program = frama_c.program()
    if program is None:
        return Diagnostic(
            Code.MISSING_EXTRA,
            "`--with frama-c` needs Frama-C, and there is no `frama-c` on the PATH",
            help="Debian and Ubuntu: `apt install frama-c-base`; elsewhere: frama-c.com",
        )
    if request.monitor is not None and request.header is None:
        return Diagnostic(
            Code.BAD_USAGE,
            f"`--with frama-c` takes a monitor in C, and `{request.monitor.name}` is none",
            help="name a file that `--emit c` wrote",
        )
    return [_proof(rule, project, request, program) for rule in rules]


def _proof(rule: Formalized, project: Project, request: Request, program: str) -> Proof:
    request.progress(f"{rule.id}: Frama-C")
    refused = TARGET.refuse(rule)
    if refused is not None:
        return unknown(rule.id, Layer.MONITOR, CLAIM, refused.message)
    examined = analysed(rule, _given(rule, request), program, request.limits, project.rules)
    machines = " and ".join(f"`{name}`" for name in frama_c.MACHINES)
    under = (f"C is that of the machines {machines} of Frama-C: an `int` has 16 or 32 bits",)
    engine, artefacts = examined.compiler, examined.artefacts
    return proof(rule.id, Layer.MONITOR, CLAIM, examined.outcome, engine, under, artefacts)


def _given(rule: Formalized, request: Request) -> Given:
    if request.monitor is not None and request.header is not None:
        texts = [(each.name, each.text) for each in (request.monitor, request.header)]
    else:
        texts = [(str(each.path), each.text) for each in TARGET.emit((rule,))]
    (name, text), (header_name, header) = texts
    return Given(PurePath(name).name, text, PurePath(header_name).name, header)
