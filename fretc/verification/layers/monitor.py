"""Layer MONITOR: the text of a monitor means what its sentence says."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePath

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof, not_checked, proof
from compiler.project.folder import Project
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import Stopped
from fretc.verification.layers.request import Request, setup_of
from fretc.verification.monitor.verifying import MOST_STATES, verified
from fretish.diagnostics.diagnostic import Code, Diagnostic

CLAIM = "the monitor means what the sentence says"
ENGINE = "fretc, lock step with the counter automaton of the sentence"


def prove(
    rules: Sequence[Formalized], project: Project, request: Request
) -> Iterable[Proof] | Diagnostic:
    """One proof for each rule; the text may hold monitors of other rules, too.

    A diagnostic where it is in C and no compiler is installed.

    Raises:
        NotAMonitorError: the given text is no generated monitor.
    """
    if request.header is not None:
        return _of_binary(rules, project, request)
    return _of_python(rules, project, request)


def _of_python(rules: Sequence[Formalized], project: Project, request: Request) -> Iterator[Proof]:
    for rule in rules:
        file = setup_of(rule, project, request).monitor
        request.progress(f"{rule.id}: monitor")
        outcome = processes.confined(
            request.limits, verified, rule, file.text, MOST_STATES, tuple(project.rules)
        )
        if isinstance(outcome, Stopped):
            outcome = not_checked(outcome.reason)
        artefacts = {file.name: sha256(file.text)}
        yield proof(rule.id, Layer.MONITOR, CLAIM, outcome, ENGINE, (), artefacts)


def _of_binary(
    rules: Sequence[Formalized], project: Project, request: Request
) -> Iterable[Proof] | Diagnostic:
    """Proofs of a monitor in C."""
    from fretc.verification.compiled import c_build, c_verifying

    program = c_build.compiler()
    if program is None:
        names = ", ".join(f"`{name}`" for name in c_build.COMPILERS)
        return Diagnostic(
            Code.MISSING_EXTRA,
            f"a monitor in C is compiled for its proof, and there is none of {names}",
            help="install a C compiler, as with `apt install gcc`",
        )
    assert request.monitor is not None
    assert request.header is not None
    given = c_verifying.Given(
        PurePath(request.monitor.name).name,
        request.monitor.text,
        PurePath(request.header.name).name,
        request.header.text,
    )
    proofs = list[Proof]()
    for rule in rules:
        request.progress(f"{rule.id}: monitor in C")
        found = c_verifying.verified(rule, given, program, request.limits, project.rules)
        under = (f"the binary is what was proved: {found.compiler}",) if found.compiler else ()
        engine = f"{ENGINE} and the monitor in Python"
        proofs.append(
            proof(rule.id, Layer.MONITOR, CLAIM, found.outcome, engine, under, found.artefacts)
        )
    return proofs
