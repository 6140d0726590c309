"""The safety instrumented function of one requirement: the agent that reacts to its trigger.

A condition in disjunctive form becomes plans: one for each event that can make it true, guarded by
the rest of the condition. The response is an action for each of its propositions, and the belief
that it was done. Percepts are believed one after the other. If one of them is negated, a property
sees the condition true between two of them, but when the event is planned the guard rejects it. The
form without those guards responds to every such event, even if the rest does not hold. One trigger
with one response is released when the trigger goes, without a guard: with a guard, the event of a
trigger that returns during the release would be discarded, and the response lost. All other
responses are not released, because events would come faster than they are handled. They respond
once, and a guard records that.
"""

from __future__ import annotations

from collections.abc import Mapping

from compiler.agents.gwendolen import Action, BeliefChange, BeliefGuard, Deed
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.spelling.reserved_words import AJPF_ACTIONS
from compiler.targets.ajpf import names
from compiler.targets.comparison_names import comparison_names
from compiler.targets.target import not_expressible
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.declarations import Modality
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic

_TARGET = "an agent"


@dataclass(frozen=True, slots=True)
class AgentReaction:
    """A plan of the agent."""

    event: BeliefChange
    guards: tuple[BeliefGuard, ...]
    deeds: tuple[Deed, ...]


@dataclass(frozen=True, slots=True)
class Sif:
    """The agent of one requirement, and the percepts of its environment."""

    agent: str
    percepts: tuple[str, ...]
    """Propositions of the scope, the condition and the stop condition, in this order."""
    responses: tuple[str, ...]
    names: Mapping[str, str]
    """The names of percepts, responses and other propositions in the texts."""
    plans: tuple[AgentReaction, ...]
    mutant: tuple[AgentReaction, ...]
    """The plans without the deeds that make the response true."""
    released: bool
    """Whether the response is taken back when the trigger goes."""
    over_responds: bool
    """Whether plans ignore the rest of the condition, and so respond without it, too."""

    @property
    def drawn(self) -> tuple[str, ...]:
        """The names of the percepts in the texts."""
        return tuple(self.names[name] for name in self.percepts)


Term = tuple[tuple[str, bool], ...]
"""A conjunction: propositions, each true or false."""


def sif(requirement: FormalizedRequirement, guarded: bool = True) -> Sif | Diagnostic:
    """The agent that reacts as the requirement demands; F601 if there is no such agent.

    Args:
        requirement: the requirement.
        guarded: whether plans check the rest of the condition, if there is any.
    """
    sentence = requirement.sentence
    comparison = next(iter(comparison_names(requirement)), None)
    if comparison is not None:
        fix = "bind it as a proposition, and use that; `--emit ajpf` writes only the property"
        return not_expressible(_TARGET, requirement, f"`{comparison}`", fix)
    if sentence.condition is None:
        fix = "an agent reacts to an event: state what triggers it, `whenever ...`"
        return not_expressible(_TARGET, requirement, "a sentence without a condition", fix)
    terms = _terms(requirement, sentence.condition.expression)
    if isinstance(terms, Diagnostic):
        return terms
    responses = _responses(requirement)
    if isinstance(responses, Diagnostic):
        return responses
    percepts = _percepts(sentence)
    mistake = _wrong_name(requirement, percepts, responses)
    if mistake is not None:
        return mistake
    believed = [name for name in responses if _is_belief(requirement, name)]
    released = len(terms) == len(terms[0]) == len(responses) == len(believed) == 1
    answer = tuple(deed for name in responses for deed in _answer(requirement, name))
    spoilt = tuple(Action(_action(requirement, name)) for name in believed)
    spelt = _spelt(requirement)
    terms = tuple(tuple((spelt[name], value) for name, value in term) for term in terms)
    last = BeliefGuard(False, spelt[believed[-1]]) if believed and not released else None
    plans, mutant = (
        (
            *_reactions(terms if guarded else _alone(terms), deeds, last),
            *(_releases(terms, spelt[responses[0]]) if released else ()),
        )
        for deeds in (answer, spoilt)
    )
    bare = not guarded and terms != _alone(terms)
    agent = names.agent(requirement)
    return Sif(agent, percepts, responses, spelt, plans, mutant, released, bare)


def _terms(
    requirement: FormalizedRequirement, condition: e.Expression
) -> tuple[Term, ...] | Diagnostic:
    """The condition as a disjunction; each term has a proposition that has to be true."""
    parts = condition.args if isinstance(condition, e.Or) else (condition,)
    terms: list[Term] = []
    for part in parts:
        literals = [_literal(x) for x in (part.args if isinstance(part, e.And) else (part,))]
        term = tuple(literal for literal in literals if literal is not None)
        if len(term) < len(literals):
            fix = "write it as `a`, `a & b` or `(a & !b) | c`, or bind its parts as propositions"
            return not_expressible(_TARGET, requirement, "the shape of the condition", fix)
        if not any(positive for _, positive in term):
            fix = "a belief that is absent at the start raises no event: bind the opposite"
            return not_expressible(_TARGET, requirement, "a condition that only negates", fix)
        terms.append(term)
    return tuple(terms)


def _alone(terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """Each literal as a term of its own."""
    return tuple(dict.fromkeys((literal,) for term in terms for literal in term))


def _literal(expression: e.Expression) -> tuple[str, bool] | None:
    match expression:
        case e.Name(id):
            return id, True
        case e.Not(e.Name(id)):
            return id, False
        case _:
            return None


def _responses(requirement: FormalizedRequirement) -> tuple[str, ...] | Diagnostic:
    response = requirement.sentence.response
    parts = response.args if isinstance(response, e.And) else (response,)
    ids = [part.id for part in parts if isinstance(part, e.Name)]
    if len(ids) == len(parts):
        return tuple(dict.fromkeys(ids))
    fix = "an agent reacts by actions: state the response as `a` or `a & b`"
    return not_expressible(_TARGET, requirement, "the shape of the response", fix)


def _percepts(sentence: s.Sentence) -> tuple[str, ...]:
    """The propositions of scope, condition and stop condition, which the environment draws."""
    assert sentence.condition is not None
    stop = s.stop(sentence.timing)
    expressions = [
        *([sentence.scope.mode] if sentence.scope else []),
        sentence.condition.expression,
        *([stop] if stop else []),
    ]
    return tuple(dict.fromkeys(name.id for part in expressions for name in e.names(part)))


def _wrong_name(
    requirement: FormalizedRequirement, percepts: tuple[str, ...], responses: tuple[str, ...]
) -> Diagnostic | None:
    for name in percepts:
        if name in responses:
            fix = "if the environment shows the response, every agent is verified: use two names"
            return not_expressible(_TARGET, requirement, f"`{name}` as trigger and response", fix)
        if _modality(requirement, name) is not Modality.BELIEF:
            fix = 'a trigger is a percept: remove its `modality`, or make it "B"'
            return not_expressible(
                _TARGET, requirement, f"the trigger `{name}` (not a belief)", fix
            )
    for name in responses:
        if _modality(requirement, name) not in (Modality.BELIEF, Modality.DONE):
            fix = 'an agent brings about a belief ("B") or does an action ("D")'
            return not_expressible(
                _TARGET, requirement, f"the response `{name}` (neither a belief nor an action)", fix
            )
        done = _modality(requirement, name) is Modality.DONE
        action = _spelt(requirement)[name] if done else _action(requirement, name)
        if action in AJPF_ACTIONS:
            fix = "MCAPL reserves this name: use another"
            return not_expressible(_TARGET, requirement, f"the action `{action}`", fix)
    return None


def _spelt(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """The names in the texts, also by names in the syntax tree, which have no quotes."""
    spelt = names.spelt(requirement)
    return {**spelt, **{atom[1:-1]: spelt[atom] for atom in spelt if atom.startswith('"')}}


def _modality(requirement: FormalizedRequirement, name: str) -> Modality:
    declared = requirement.glossary.get(name)
    return declared.modality if declared else Modality.BELIEF


def _is_belief(requirement: FormalizedRequirement, *names: str) -> bool:
    return all(_modality(requirement, name) is Modality.BELIEF for name in names)


def _answer(requirement: FormalizedRequirement, name: str) -> tuple[Deed, ...]:
    """An action and the belief that it was done; only the action if that is the response."""
    if not _is_belief(requirement, name):
        return (Action(_spelt(requirement)[name]),)
    return Action(_action(requirement, name)), BeliefChange("+", _spelt(requirement)[name])


def _action(requirement: FormalizedRequirement, name: str) -> str:
    """The action that makes the proposition true, as the bindings name it."""
    declared = requirement.glossary.get(name)
    return (declared.action if declared else "") or f"do_{_spelt(requirement)[name]}"


def _reactions(
    terms: tuple[Term, ...], answer: tuple[Deed, ...], last: BeliefGuard | None
) -> tuple[AgentReaction, ...]:
    """A plan for each event that can make a term true; the guard `last` blocks a second answer."""
    plans = [
        AgentReaction(
            BeliefChange("+" if positive else "-", name),
            (
                *(BeliefGuard(value, other) for other, value in term if other != name),
                *([last] if last else []),
            ),
            answer,
        )
        for term in terms
        for name, positive in term
    ]
    return tuple(dict.fromkeys(plans))


def _releases(terms: tuple[Term, ...], response: str) -> tuple[AgentReaction, ...]:
    """The plan that takes the only response back when the only trigger goes."""
    (((trigger, _),),) = terms
    deeds = (Action(f"undo_{response}"), BeliefChange("-", response))
    return (AgentReaction(BeliefChange("-", trigger), (), deeds),)
