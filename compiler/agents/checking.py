"""The layer AGENT of `fretc verify`: the texts of an agent and of its properties, in a model.

The texts that are checked are the `.gwen` and `.psl` files that MCAPL would read, not the
requirement behind them. Two checks of the check accompany each verdict: the controls of a property
must be violated, and an agent without the response must violate the property.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from compiler.agents import gwendolen, psl
from compiler.agents.gwendolen import Action, Agent, BeliefChange
from compiler.agents.model import AgentState, Model, narration
from compiler.agents.psl import Property
from compiler.agents.psl_printing import property_text
from compiler.agents.vacuity import positive_atoms, without_consequences
from compiler.files import records
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic import spot as automata
from compiler.logic.claims import (
    ClaimOutcome,
    ClaimResult,
    ClaimTrace,
    Layer,
    Proof,
    not_checked,
    proof,
    proved,
    refuted,
    vacuous,
)
from compiler.logic.kripke import Explored, Lasso, ModelTooLargeError, check
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.recursion import with_recursion_limit

STATES = 200_000
"""Default limit of the number of states to explore."""
CONTROLS = ("reach", "resp", "stop")
"""`<key>_reach` is a control of `<key>`: it must be violated."""
_ATOM = re.compile(r"(?P<modality>[A-Za-z]+)\((?P<agent>\w+),(?P<literal>.*)\)", re.DOTALL)
_PERCEPT = re.compile(r"[a-z][A-Za-z0-9_]*(?:\([A-Za-z0-9_,. -]+\))?", re.ASCII)


@with_recursion_limit
def check_agent(
    agent: Source, properties: Source, percepts: Sequence[str], limit: int = STATES
) -> tuple[Proof, ...] | Diagnostic:
    """Evidence for each property of the file, in its order.

    Args:
        agent: a `.gwen`.
        properties: a `.psl`.
        percepts: the percepts that the environment draws freely; the agent perceives nothing else.
        limit: the number of states to explore; a property of a larger model is not checked.

    Returns:
        The evidence; or the first text that MCAPL would read differently (F603, F610), a property
        of another agent (F612), or an invalid percept (F613).
    """
    return _checked(agent, properties, percepts, limit, None)


@with_recursion_limit
def agent_evidence(
    requirement: FormalizedRequirement,
    files: Mapping[str, str],
    percepts: Sequence[str],
    limit: int = STATES,
) -> tuple[Proof, ...]:
    """Evidence for the texts of a bundle.

    Args:
        requirement: its id names the evidence; nothing else of it is read.
        files: texts by the names `SIF.gwen`, `SIF_mutant.gwen` and `SIF.psl`.
        percepts: the percepts that the environment of the bundle draws.
        limit: the number of states to explore.
    """
    sif, mutant, properties = (
        Source(name, files[name]) for name in ("SIF.gwen", "SIF_mutant.gwen", "SIF.psl")
    )
    evidence = _checked(sif, properties, percepts, limit, mutant)
    if isinstance(evidence, Diagnostic):
        reason = f"{evidence.code.number} {evidence.message}"
        claim = f"the agent of {requirement.id} has its properties"
        return (proof(requirement.id, Layer.AGENT, claim, not_checked(reason), "fretc"),)
    return tuple(records.replace(line, requirement=requirement.id) for line in evidence)


def _checked(
    agent: Source,
    properties: Source,
    percepts: Sequence[str],
    limit: int,
    mutant: Source | None,
) -> tuple[Proof, ...] | Diagnostic:
    props = psl.read(properties)
    if isinstance(props, Diagnostic):
        return props
    drawn: dict[str, None] = {}
    for name in percepts:
        percept = _percept(name)
        if isinstance(percept, Diagnostic):
            return percept
        drawn[percept] = None
    read = gwendolen.read(agent)
    broken = None if mutant is None else gwendolen.read(mutant)
    artefacts = {s.name: sha256(s.text) for s in (agent, properties, mutant) if s is not None}
    if not props:
        claim, reason = "the agent has its properties", f"`{properties.name}` has none"
        return (proof("agent", Layer.AGENT, claim, not_checked(reason), "fretc", (), artefacts),)
    for reading in (read, broken):
        if isinstance(reading, Diagnostic) and reading.code is not Code.BEYOND_MODEL:
            return reading
        if isinstance(reading, Diagnostic):
            line = f", line {reading.span.line}" if reading.span else ""
            return _unknown(props, f"{reading.message} ({agent.name}{line})", artefacts)
    assert isinstance(read, Agent)
    for prop in props:
        mismatch = _other_agent(prop, read)
        if mismatch is not None:
            return mismatch
    if not automata.is_installed():
        return _unknown(props, automata.ABSENT, artefacts)
    try:
        explored = _ExploredModel.of(Model(read, tuple(drawn)), limit)
        spoilt = broken if isinstance(broken, Agent) else None
        return tuple(_PropertyProofs(props, explored, spoilt, artefacts, limit).all())
    except ModelTooLargeError as error:
        return _unknown(props, f"the agent has {error}", artefacts)


def _percept(name: str) -> str | Diagnostic:
    """The name as the agent spells beliefs; F613 if it is not a percept."""
    if _PERCEPT.fullmatch(name):
        text = f"GWENDOLEN :name: a :Initial Beliefs: {name} :Initial Goals: :Plans: +a : {{True}};"
        agent = gwendolen.read(Source("percept", text))
        if isinstance(agent, Agent):
            return agent.beliefs[0]
    return diagnostic("bad_percept", name=name)


def _other_agent(prop: Property, agent: Agent) -> Diagnostic | None:
    for atom in f.atoms(prop.formula):
        match = _ATOM.fullmatch(atom)
        if match is not None and match["agent"] != agent.name:
            return diagnostic(
                "property_of_other_agent",
                prop.span,
                key=prop.key,
                other=match["agent"],
                agent=agent.name,
            )
    return None


def _unknown(
    props: Sequence[Property], reason: str, artefacts: Mapping[str, str]
) -> tuple[Proof, ...]:
    return tuple(
        proof(p.key, Layer.AGENT, _claim(p), not_checked(reason), "fretc", (), artefacts)
        for p in props
    )


def _claim(prop: Property) -> str:
    return f"every run of the agent keeps {prop.key}: {_text(prop.formula)}"


def _text(formula: f.Formula) -> str:
    return property_text(formula, lambda atom: atom)


@dataclass(frozen=True, slots=True)
class _ExploredModel:
    """A model with all of its reachable states."""

    model: Model
    graph: Explored[AgentState]

    @staticmethod
    def of(model: Model, limit: int) -> _ExploredModel:
        return _ExploredModel(model, model.explored(limit))

    @property
    def size(self) -> str:
        return f"{len(self.graph.states):,} states"

    def violation(self, formula: f.Formula) -> Lasso | None:
        return check(self.graph.kripke, formula)

    def trace(self, formula: f.Formula, lasso: Lasso) -> ClaimTrace:
        """The lasso as a table: a row for each state, with the atoms and the event before."""
        names = tuple(f.atoms(formula))
        labels = [self.graph.kripke.labels[state] for state in lasso.states]
        return ClaimTrace(
            names,
            tuple(tuple(name in label for name in names) for label in labels),
            narration(self.model, self.graph, lasso.states),
            len(lasso.prefix),
        )

    def never(self, formula: f.Formula) -> list[str]:
        """A reason, in words, for each atom of the formula that no state makes true."""
        labels = self.graph.kripke.labels
        absent = [a for a in f.atoms(formula) if not any(a in label for label in labels)]
        return [self._why(atom) for atom in absent]

    def _why(self, atom: str) -> str:
        match = _ATOM.fullmatch(atom)
        literal = match["literal"] if match else atom
        deeds = [deed for plan in self.model.agent.plans for deed in plan.deeds]
        if Action(literal) in deeds and atom.startswith("B("):
            return f"`{literal}` is an action, and an action is never a belief"
        if literal in self.model.percepts or BeliefChange("+", literal) in deeds:
            return f"nothing makes `{literal}` true"
        return f"no environment shows `{literal}`, and no plan adds it"


@dataclass(frozen=True, slots=True)
class _PropertyProofs:
    """The evidence of one file of properties."""

    properties: tuple[Property, ...]
    explored: _ExploredModel
    mutant: Agent | None
    """An agent that must violate the properties. None: each property gets its own mutant."""
    artefacts: Mapping[str, str]
    limit: int

    def all(self) -> Iterator[Proof]:
        for prop in self.properties:
            if self._main_of(prop) is not None:
                yield self._line(prop, _control_claim(prop), self._control(prop))
                continue
            outcome = self._main(prop)
            yield self._line(prop, _claim(prop), outcome)
            if outcome.result is ClaimResult.PROVED:
                yield from self._of_mutant(prop)

    def _line(self, prop: Property, claim: str, outcome: ClaimOutcome) -> Proof:
        engine = f"explicit states, Spot {automata.version()}"
        assumed = _assumptions(self.explored.model.percepts)
        return proof(prop.key, Layer.AGENT, claim, outcome, engine, assumed, self.artefacts)

    def _main_of(self, prop: Property) -> Property | None:
        """The property of which `prop` is a control."""
        main, _, name = prop.key.rpartition("_")
        if name not in CONTROLS:
            return None
        return next((p for p in self.properties if p.key == main), None)

    def _main(self, prop: Property) -> ClaimOutcome:
        if any("_" in re.findall(r"\b_\b", atom) for atom in f.atoms(prop.formula)):
            return not_checked("`_`, which matches everything, is not in the model")
        lasso = self.explored.violation(prop.formula)
        if lasso is not None:
            detail = (
                f"a run of {len(lasso.states)} stages violates it ({self.explored.size} in all)"
            )
            return refuted(detail, self.explored.trace(prop.formula, lasso))
        why = self._vacuous(prop)
        size = self.explored.size
        return vacuous(why) if why else proved(f"all runs through {size} keep it")

    def _vacuous(self, prop: Property) -> str | None:
        for conditions, rest in without_consequences(prop.formula):
            if self.explored.violation(rest) is None:
                reasons = "; ".join(self.explored.never(f.And(conditions)))
                because = f": {reasons}" if reasons else ""
                condition_text = " and ".join(f"`{_text(condition)}`" for condition in conditions)
                return f"never true where it counts: {condition_text}{because}"
        for other in self.properties:
            if self._main_of(other) == prop and self.explored.violation(other.formula) is None:
                reasons = "; ".join(self.explored.never(other.formula))
                because = f": {reasons}" if reasons else ""
                return f"its control {other.key} holds{because}"
        return None

    def _control(self, prop: Property) -> ClaimOutcome:
        lasso = self.explored.violation(prop.formula)
        if lasso is None:
            reasons = "; ".join(self.explored.never(prop.formula)) or "every run keeps it"
            return vacuous(f"{prop.key} holds: {reasons}")
        return proved(f"a run of {len(lasso.states)} stages violates {prop.key}, as it should")

    def _of_mutant(self, prop: Property) -> Iterator[Proof]:
        mutant = self.mutant or _without(self.explored.model.agent, positive_atoms(prop.formula))
        claim = f"the check can fail: an agent without the response violates {prop.key}"
        if mutant is None:
            return
        spoilt = _ExploredModel.of(Model(mutant, self.explored.model.percepts), self.limit)
        if spoilt.violation(prop.formula) is None:
            detail = f"that agent satisfies {prop.key}, too, so {prop.key} shows no response"
            yield self._line(prop, claim, vacuous(detail))
        else:
            yield self._line(prop, claim, proved(f"it does, within {spoilt.size}"))


def _control_claim(prop: Property) -> str:
    return f"some run of the agent violates the control {prop.key}: {_text(prop.formula)}"


def _without(agent: Agent, atoms: frozenset[str]) -> Agent | None:
    """The agent without the deeds that make the atoms true; None if it has no such deed."""
    name = agent.name

    def makes(deed: gwendolen.Deed) -> bool:
        if isinstance(deed, Action):
            return f"D({name},{deed.name})" in atoms
        return deed.sign == "+" and f"B({name},{deed.belief})" in atoms

    if not any(makes(deed) for plan in agent.plans for deed in plan.deeds):
        return None
    plans = (
        replace(plan, deeds=tuple(deed for deed in plan.deeds if not makes(deed)))
        for plan in agent.plans
    )
    return replace(agent, plans=tuple(plans))


def _assumptions(percepts: Sequence[str]) -> tuple[str, ...]:
    draws = f"exactly {', '.join(percepts)}, each freely," if percepts else "nothing"
    return (
        f"the environment shows {draws} anew at the start, at every action and whenever the "
        "agent is idle, for ever (--percept)",
        "percepts that are drawn together are believed one after the other, in any order",
        "intentions take turns, first come, first served, one deed a turn",
        "the agent is always scheduled again",
    )
