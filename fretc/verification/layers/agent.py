"""Layer AGENT: the text of an agent has its properties."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.agents.checking import checked
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof
from compiler.project.folder import Project
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf import properties as ajpf
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import Limits, Stopped
from fretc.verification.layers.request import Request, named_text, unknown
from fretish.diagnostics.diagnostic import Diagnostic

CLAIM = "the agent has its properties"


def prove(
    rules: Sequence[Formalized], project: Project, request: Request
) -> tuple[Proof, ...] | Diagnostic:
    """Of the agent that is given; else of the one that the bundle of each rule has."""
    request.progress("agent: its properties")
    agent, properties = request.agent, request.properties
    if agent is None or properties is None:
        return tuple(proof for rule in rules for proof in _bundle(rule, request.limits))
    proofs = processes.confined(request.limits, checked, agent, properties, request.percepts)
    if isinstance(proofs, Stopped):
        return (unknown("agent", Layer.AGENT, CLAIM, proofs.reason, named_text(agent)),)
    return proofs


def _bundle(rule: Formalized, limits: Limits) -> tuple[Proof, ...]:
    refused = ajpf.refusal(rule)
    agent = processes.confined(limits, bundle.checked_agent, rule) if refused is None else refused
    if isinstance(agent, Diagnostic):
        return (unknown(rule.id, Layer.AGENT, CLAIM, f"there is none: {agent.message}"),)
    if isinstance(agent, Stopped):
        return (unknown(rule.id, Layer.AGENT, CLAIM, agent.reason),)
    return agent.evidence
