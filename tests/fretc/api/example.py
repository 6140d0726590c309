"""A program of a user, which a type checker accepts in its strict mode, and nothing less typed."""

from __future__ import annotations

from typing import assert_type

import fretc


def everything(folder: str, log: str) -> list[str]:
    project: fretc.Project = fretc.read_project(folder)
    requirement: fretc.FormalizedRequirement = fretc.formalize("the rover shall always satisfy p")
    assert_type(fretc.formulas(requirement), fretc.Formulas)
    assert_type(fretc.formulas(requirement).past, str | None)
    monitor = fretc.load_monitor(*project.formalized, requirement)
    assert_type(monitor, fretc.Monitor)
    monitor.step(p=True)
    stream = fretc.Stream(project)
    stream.add("vx", 1, 0.5)
    ticks: tuple[fretc.Tick, ...] = stream.until(2)
    assert_type(stream.end(), fretc.End)
    audit = fretc.audit_logs(project, log)
    assert_type(audit, fretc.Audit)
    verdicts: list[str] = [result.verdict for result in audit.results]
    proofs: tuple[fretc.Proof, ...] = fretc.verify(project)
    try:
        return [
            fretc.make_report(project).html,
            fretc.monitor_text(requirement),
            *verdicts,
            str((ticks, proofs)),
        ]
    except fretc.Refusal as refusal:
        return [diagnostic.message for diagnostic in refusal.diagnostics]
