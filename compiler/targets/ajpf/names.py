"""Names in AJPF and Gwendolen for a requirement's propositions and its agent."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.agents.psl_grammar import AGENT
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of
from compiler.logic.identifiers import legal_names
from compiler.logic.printing import identifier
from compiler.logic.spelling.reserved_words import AJPF
from compiler.targets.comparison_names import comparison_names
from compiler.targets.comparison_names import definitions as meanings


def spelt(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """A functor for each proposition: it begins with a small letter, and is not a key word."""
    spoken = comparison_names(requirement)
    atoms = tuple(dict.fromkeys((*requirement.propositions, *atoms_of(requirement.sentence))))
    wanted = {atom: _functor(spoken.get(atom) or identifier(atom)) for atom in atoms}
    return legal_names(atoms, AJPF, names=wanted)


def _functor(name: str) -> str:
    return name if name[0].islower() else f"v_{name}"


def agent(requirement: FormalizedRequirement) -> str:
    """The agent's name, which is the component's if that is legal."""
    component = requirement.sentence.component
    name = component if AGENT.fullmatch(component) else None
    return legal_names([component], AJPF, names={component: name} if name else None)[component]


def definitions(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """The meaning of each name that differs from the user's."""
    component, own = requirement.sentence.component, agent(requirement)
    by_name = meanings(requirement, spelt(requirement))
    return by_name if own == component else {**by_name, own: f"the agent `{component}`"}


def everything(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """Names of propositions and of the agent; a proposition wins if both have the same name."""
    return {requirement.sentence.component: agent(requirement), **spelt(requirement)}
