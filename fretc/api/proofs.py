"""Proofs that generated artefacts satisfy their requirements."""

from __future__ import annotations

import os
from collections.abc import Iterable

from compiler.logic.claims import PROVERS, Layer, Proof
from compiler.project.project import Project
from fretc.api.refusal import Refusal, accepted, bounded
from fretc.verification.ajpf_results import ajpf_proofs
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.layers.request import Request
from fretc.verification.verify import missing_prover, prove, refusals
from fretish.diagnostics.diagnostic import has_errors
from fretish.diagnostics.messages import diagnostic

Path = str | os.PathLike[str]


@bounded
def verify(
    project: Project,
    *,
    layers: Iterable[str] | None = None,
    provers: Iterable[str] = (),
    ajpf: Iterable[Path] = (),
    limit: int = 60,
) -> tuple[Proof, ...]:
    """Prove, layer by layer, that the generated artefacts satisfy the requirements.

    Args:
        project: the requirements and their bindings.
        layers: some of `monitor`, `interceptor`, `loop`, `bounds`, `agent`, `ajpf`, for every
            requirement; None: each of them where it applies, and `agent` where a requirement plans
            it or `ajpf`.
        provers: `frama-c`, `dafny` or `crosshair`, if they are installed.
        ajpf: result files of AJPF.
        limit: CPU seconds for each claim.

    Returns:
        A proof for each claim: `proved`, `counterexample`, `vacuous`, `not checked`, or `not
        applicable` where neither `layers` nor the requirement's `verify` names the layer.

    Raises:
        Refusal: a requirement has an error, or no monitor can express it.
    """
    if has_errors(project.diagnostics):
        raise Refusal(mistake for mistake in project.diagnostics if mistake.is_error)
    every = tuple(map(str, Layer))
    demanded = () if layers is None else _named("layer", layers, every)
    chosen_layers = demanded if layers is not None else every
    chosen_provers = _named("prover", provers, PROVERS)
    if not project.formalized or not chosen_layers:
        raise Refusal((diagnostic("nothing_to_verify"),))
    if limit < 1:
        raise Refusal((diagnostic("bad_time_limit", limit=limit),))
    results, remarks = ajpf_proofs(project.formalized, [os.fspath(path) for path in ajpf])
    if has_errors(remarks):
        raise Refusal(remarks)
    request = Request(
        [Layer(name) for name in chosen_layers],
        CallLimits(seconds=limit),
        demanded=[Layer(name) for name in demanded],
        provers=chosen_provers,
        ajpf=results,
    )
    absent = missing_prover(request)
    errors = [*refusals(project, request).values(), *([absent] if absent else [])]
    if errors:
        raise Refusal(errors)
    return accepted(prove(project, request))


def _named(what: str, choice: Iterable[str], names: tuple[str, ...]) -> tuple[str, ...]:
    chosen = tuple(dict.fromkeys([choice] if isinstance(choice, str) else choice))
    for name in chosen:
        if name not in names:
            listed = ", ".join(names)
            raise Refusal((diagnostic("unknown_choice", what=what, name=name, names=listed),))
    return chosen
