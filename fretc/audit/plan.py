"""The plan of an audit: a value that can be sent to any process or machine."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Mapping, Sequence
from dataclasses import astuple, field
from functools import lru_cache, partial

from compiler.files.build_id import build_id
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.project.project import Project
from compiler.situations.situations import situations
from compiler.targets.python import monitor as monitors
from fretc.audit.evidence.claim import AuditedRequirement
from fretc.audit.evidence.schema import SCHEMA, Selection
from fretc.audit.evidence.verdict_inputs import VerdictInputs
from fretc.audit.expected_response import demand
from fretc.audit.measurements import confidence_intervals as intervals
from fretc.audit.measurements.count_trials import chance, trials
from fretc.audit.one_log import MonitoredRequirement
from fretc.audit.project_inputs import all_verdict_inputs
from fretc.audit.refusals import RefusedRequirement, refusals
from fretc.logs.signals.integrity import Integrity
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.documents import RequirementEntry
from fretish.reading.recursion import with_recursion_limit
from monitors.loading import load


@dataclass(frozen=True, slots=True)
class Plan:
    """The audited requirements and their bindings: all inputs of an audit except the logs."""

    claims: tuple[AuditedRequirement, ...]
    declarations: Declarations = field(compare=False, repr=False)
    """The declarations, with only the signals that the requirements read."""
    integrity: Integrity
    """How thoroughly a log is checked."""
    digest: str
    """SHA-256 of everything in the plan by which a single log is judged, byte for byte."""
    confidence: float = intervals.CONFIDENCE
    """The confidence of bounds of a probability over all logs."""
    refused: tuple[RefusedRequirement, ...] = field(default=(), compare=False, repr=False)
    """The requirements in force that cannot be audited."""
    labels: Mapping[str, str] = field(default_factory=dict, compare=False)
    """The labels that the command gives all runs. They are not part of the key, because no audit of
    a log depends on them."""
    selection: Selection | None = field(default=None, compare=False, repr=False)
    """The selection of the named logs, for the evidence; None: all."""

    @property
    def key(self) -> str:
        """SHA-256 of the digest and the version of fretc."""
        return sha256(f"{build_id()} {self.digest}")

    @property
    def named(self) -> tuple[AuditedRequirement | RefusedRequirement, ...]:
        """All requirements in force: those that are audited, then those that cannot be."""
        return (*self.claims, *self.refused)

    @property
    def refusals(self) -> tuple[Diagnostic, ...]:
        """The diagnostics that keep requirements from being judged."""
        return tuple(dict.fromkeys(reason for each in self.refused for reason in each.why))


def planned(
    project: Project,
    integrity: Integrity = Integrity.HASH,
    confidence: float = intervals.CONFIDENCE,
) -> Plan | tuple[Diagnostic, ...]:
    """The plan to audit every requirement that is not retired, or the diagnostics that prevent it.

    A requirement that cannot be judged is among the `refused` of the plan. There is a plan if at
    least one can be judged.

    Args:
        project: a project without errors, except those of single requirements.
        integrity: how thoroughly a log is checked beyond the bound messages.
        confidence: the confidence of bounds of a probability, between 0.5 and 1.
    """
    declarations = project.declarations
    unauditable = refusals(project)
    left_out = {entry for entry, _ in unauditable}
    requirements = [
        requirement for requirement in project.in_force if requirement.entry not in left_out
    ]
    errors = tuple(dict.fromkeys(reason for _, why in unauditable for reason in why))
    if declarations is None or not requirements:
        return errors or (diagnostic("nothing_to_audit"),)
    texts = {requirement.entry: monitors.text(requirement) for requirement in requirements}
    inputs_of = all_verdict_inputs(
        project, monitors={place: sha256(text) for place, text in texts.items()}
    )
    is_traced = declarations.agent_trace is not None
    claims = tuple(
        _claim(
            requirement,
            inputs_of[requirement.entry],
            texts[requirement.entry],
            _beliefs(requirement) if is_traced else (),
        )
        for requirement in requirements
    )
    refused = tuple(_refused(inputs_of, entry, why) for entry, why in unauditable)
    used = declarations.restricted_to(
        name for requirement in requirements for name in requirement.watched
    )
    digest = _digest(claims, refused, used, integrity)
    one_each = tuple({each.id: each for each in reversed(refused)}.values())[::-1]
    return Plan(claims, used, integrity, digest, confidence, one_each)


def _refused(
    inputs_of: Mapping[RequirementEntry, VerdictInputs],
    requirement: RequirementEntry,
    why: tuple[Diagnostic, ...],
) -> RefusedRequirement:
    return RefusedRequirement(requirement.id, wording(requirement), inputs_of[requirement], why)


def _beliefs(requirement: FormalizedRequirement) -> tuple[tuple[str, str], ...]:
    from compiler.targets.ajpf.names import spelt

    return tuple((name, belief) for name, belief in spelt(requirement).items() if name != belief)


def _claim(
    requirement: FormalizedRequirement,
    verdict_inputs: VerdictInputs,
    monitor: str,
    beliefs: tuple[tuple[str, str], ...],
) -> AuditedRequirement:
    return AuditedRequirement(
        requirement.id,
        wording(requirement.entry),
        verdict_inputs,
        monitor,
        demand(requirement),
        situations(requirement, exact=True),
        chance(requirement),
        requirement.entry.is_assumption,
        beliefs,
    )


@with_recursion_limit
def _digest(
    claims: Sequence[AuditedRequirement],
    refused: Sequence[RefusedRequirement],
    declarations: Declarations,
    integrity: Integrity,
) -> str:
    """SHA-256 of the plan, with positions in the bindings: diagnostics name their lines."""
    digest = hashlib.sha256(pickle.dumps(declarations, protocol=5))
    texts = [
        (c.id, c.sentence, dict(c.verdict_inputs), c.monitor, astuple(c.demand), c.is_assumption)
        for c in claims
    ]
    reasons = [
        (r.id, r.sentence, dict(r.verdict_inputs), [d.message for d in r.why]) for r in refused
    ]
    parts = [SCHEMA, integrity, texts, reasons]
    digest.update(json.dumps(parts).encode())
    return digest.hexdigest()


@lru_cache(maxsize=4)
@with_recursion_limit
def keys(plan: Plan) -> Mapping[str, str]:
    """For each requirement, SHA-256 of all inputs of its result other than the log, byte for byte.

    Not included are facts about the log that all requirements share (its health, its labels), and
    positions in the bindings: no result depends on them.
    """
    clock, signals = plan.declarations.clock, plan.declarations.signals.values()
    topics = sorted({signal.path.topic for signal in signals})
    trace = plan.declarations.agent_trace
    common = [SCHEMA, build_id(), plan.integrity, repr(clock), topics, trace]
    requirements = zip(plan.claims, monitored_requirements(plan), strict=True)
    return {
        claim.id: sha256(json.dumps([*common, _letters(plan, claim, each.propositions)]))
        for claim, each in requirements
    }


def _letters(plan: Plan, claim: AuditedRequirement, propositions: Sequence[str]) -> list[object]:
    """The text of a requirement and of its propositions; `repr` leaves out positions."""
    read = plan.declarations.restricted_to(propositions)
    return [
        claim.id,
        claim.sentence,
        dict(claim.verdict_inputs),
        claim.monitor,
        astuple(claim.demand),
        claim.chance and claim.chance.text,
        claim.is_assumption,
        [repr(read.propositions[name]) for name in propositions],
        [repr(signal) for _, signal in sorted(read.signals.items())],
        read.assumptions,
    ]


@with_recursion_limit
def packed(plan: Plan) -> bytes:
    """The plan as bytes, for a process that trusts this one."""
    return pickle.dumps(plan, protocol=5)


@with_recursion_limit
def unpacked(data: bytes) -> Plan:
    """The plan from its bytes."""
    plan = pickle.loads(data)
    assert isinstance(plan, Plan)
    return plan


@lru_cache(maxsize=4)
def monitored_requirements(plan: Plan) -> tuple[MonitoredRequirement, ...]:
    """The requirements with their monitors, in order; loaded once in each process."""
    return tuple(
        MonitoredRequirement(
            load(f"{claim.id}_monitor", claim.monitor),
            claim.verdict_inputs,
            claim.demand,
            partial(trials, claim.chance.obligation) if claim.chance else None,
            claim.chance.obligation.atoms if claim.chance else (),
            claim.situations,
            claim.is_assumption,
            dict(claim.beliefs),
        )
        for claim in plan.claims
    )
