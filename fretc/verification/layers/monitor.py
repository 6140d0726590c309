"""Layer MONITOR: the text of a monitor means what its sentence says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof, not_checked, proof
from compiler.project.folder import Project
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import Stopped
from fretc.verification.layers.request import Request, setup_of
from fretc.verification.monitor.verifying import MOST_STATES, verified

CLAIM = "the monitor means what the sentence says"
ENGINE = "fretc, lock step with the counter automaton of the sentence"


def prove(rules: Sequence[Formalized], project: Project, request: Request) -> Iterator[Proof]:
    """One proof for each rule; the text may hold monitors of other rules, too.

    Raises:
        NotAMonitorError: the given text is no generated monitor.
    """
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
