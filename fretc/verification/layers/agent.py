"""Layer AGENT: the text of an agent satisfies its properties.

For a requirement whose header does not plan the layer, the agent of its bundle is examined only if
the user names the layer.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.agents.checking import check_agent
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimResult, Layer, Proof, not_applicable
from compiler.project.project import Project
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf import properties as ajpf
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import CallLimits, NoResult
from fretc.verification.layers.request import Request, named_text, unexamined, unknown
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.printer import timing as printing_of

CLAIM = "the agent has its properties"
_OF_AGENT = (Layer.AGENT, Layer.AJPF)
"""Planning AJPF's own verdict also plans this layer."""


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> tuple[Proof, ...] | Diagnostic:
    """Proofs about the given agent, or about the agent in the bundle of each requirement."""
    request.progress("agent: its properties")
    agent, properties = request.agent, request.properties
    if agent is None or properties is None:
        return tuple(
            proof
            for requirement in requirements
            if any(request.demands(layer, requirement.entry) for layer in _OF_AGENT)
            for proof in _bundle(requirement, request.limits)
        )
    proofs = processes.confined(request.limits, check_agent, agent, properties, request.percepts)
    if isinstance(proofs, NoResult):
        return (unknown("agent", Layer.AGENT, CLAIM, proofs.reason, named_text(agent)),)
    return proofs


def _bundle(requirement: FormalizedRequirement, limits: CallLimits) -> tuple[Proof, ...]:
    refused = ajpf.refusal(requirement)
    agent = (
        processes.confined(limits, bundle.checked_agent, requirement)
        if refused is None
        else refused
    )
    if isinstance(agent, Diagnostic):
        return (_without_agent(requirement, agent.message),)
    if isinstance(agent, NoResult):
        return (unknown(requirement.id, Layer.AGENT, CLAIM, agent.reason),)
    remark = ajpf.remark(requirement)
    refuted = any(line.result is ClaimResult.COUNTEREXAMPLE for line in agent.evidence)
    if refuted and remark is not None and remark.code in _TOO_SOON:
        timing = printing_of(requirement.sentence.timing)
        return (
            _without_agent(
                requirement,
                f"an agent cannot keep the timing `{timing}` of {requirement.id}: it needs about "
                "nine states from a percept to its response",
            ),
        )
    return agent.evidence


_TOO_SOON = (Code.STATE_ZERO, Code.NO_TIME_TO_REACT)
"""Timings that no reasoning cycle can satisfy; no bundle has such an agent."""


def _without_agent(requirement: FormalizedRequirement, reason: str) -> Proof:
    outcome = not_applicable(f"there is none: {reason}")
    return unexamined(requirement.id, Layer.AGENT, CLAIM, outcome)
