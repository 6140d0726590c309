"""Which wrong requirements recorded runs would have shown: mutants judged beside the right one.

A run notices a mutant where the two verdicts on it differ, both of them known, or where one is
certainly violated at a tick at which the other certainly is not. What is unknown notices nothing.
All mutants of a requirement are one monitor, judged over the very columns of its audit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from compiler.formalization.formalized import Formalized, plain
from compiler.formalization.resolution import extended
from compiler.project.folder import Project
from compiler.situations.mutants import Mutant, mutants
from compiler.targets.python import monitor as monitors
from fretc.audit.measurements.judgement import Judgement, each_judged
from fretc.audit.one_log import signals_of
from fretc.audit.plan import Plan
from fretc.logs.reader import read
from fretc.logs.signals.traces import trace
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic
from monitors import kernel
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


@dataclass(frozen=True)
class Suspects:
    """A requirement and its mutants, as one monitor: the requirement is the first in it."""

    id: str
    mutants: tuple[Mutant, ...]
    """Those that a monitor can judge, in its order."""
    refused: tuple[tuple[Mutant, str], ...]
    """The others, and why."""
    monitor: Monitor


@dataclass(frozen=True)
class Inquiry:
    """All that is needed beside a log to tell which mutants its run notices."""

    suspects: tuple[Suspects, ...]
    declarations: Declarations
    propositions: tuple[str, ...]
    plan: Plan


@dataclass(frozen=True, slots=True)
class Difference:
    """How a run tells a mutant from its requirement."""

    own: str
    """The verdict of the requirement."""
    other: str
    """That of the mutant."""
    tick: int | None
    """The first tick at which only one of them is violated; None: the verdicts alone differ."""


Noticed = Mapping[tuple[str, str], Difference]
"""Requirement and mutant → how a run tells them apart."""


def inquiry(project: Project, plan: Plan) -> Inquiry:
    """The mutants of each requirement that the plan audits.

    Args:
        project: that the plan is of.
        plan: of an audit.
    """
    audited = {claim.id for claim in plan.claims}
    rules = [rule for rule in project.rules if rule.id in audited]
    suspects = tuple(_suspects(rule) for rule in {rule.id: rule for rule in rules}.values())
    declarations = project.declarations
    assert declarations is not None, "there is a plan"
    for each in suspects:
        for mutant in each.mutants:
            own = mutant.rule.declarations
            if own is not None:
                declarations = extended(declarations, own.propositions, own.mistakes)
    names = tuple(
        dict.fromkeys(
            name
            for each in suspects
            for name in each.monitor.PROPOSITIONS
            if name in declarations.propositions
        )
    )
    # The clock of the audit begins with its own signals: a mutant adds none to them.
    known = {*plan.declarations.signals}
    return Inquiry(suspects, declarations.reading((*names, *_of_plan(plan))), names, plan)


def _suspects(rule: Formalized) -> Suspects:
    judged: list[Mutant] = []
    refused: list[tuple[Mutant, str]] = []
    for mutant in mutants(rule):
        why = monitors.refuse(plain(mutant.rule))
        if why is None:
            judged.append(mutant)
        else:
            refused.append((mutant, why.message))
    numbered = [_called(each.rule, f"M{n}") for n, each in enumerate(judged)]
    text = monitors.text(_called(rule, "R"), *numbered)
    return Suspects(rule.id, tuple(judged), tuple(refused), load(f"{rule.id}_mutants", text))


def _called(rule: Formalized, id: str) -> Formalized:
    """The rule under another id: in a monitor each has its own."""
    return replace(rule, requirement=replace(rule.requirement, id=id))
