"""Prover CrossHair: it confirms the contracts in the text of the interceptor."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from compiler.files import records
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.project.project import Project
from fretc.verification.engines.crosshair import contract_texts, with_crosshair
from fretc.verification.interceptor.file import PureCore, head
from fretc.verification.layers.request import Request, interceptor_of, unknown
from monitors.source_text import interceptor as original

CLAIM = "CrossHair confirms the contracts in the text"


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    """A proof for each contract of the core; the node is left out, because it would be executed.

    None if there is no interceptor.
    """
    file = interceptor_of(project, request)
    if file is None:
        return
    core = _core(file.text)
    if isinstance(core, str):
        yield unknown("interceptor", Layer.INTERCEPTOR, CLAIM, core, file)
        return
    proofs = with_crosshair(
        ast.unparse(ast.parse(core.text)),  # CrossHair reads directives in comments.
        seconds=float(request.limits.seconds),
        progress=lambda name: request.progress(f"interceptor: CrossHair, `{name}`"),
    )
    artefacts = {file.name: sha256(file.text)}
    yield from (records.replace(proof, artefacts=artefacts) for proof in proofs)


def _core(text: str) -> PureCore | str:
    """The core; or why CrossHair, which executes contracts, must not read it."""
    core = head(text)
    if isinstance(core, str) or contract_texts(core.text) == contract_texts(original().text):
        return core
    return (
        "its `pre:` and `post:` lines differ from those of fretc, and CrossHair would execute them"
    )
