"""An agent in its verification environment, as an explicit model of all its runs.

States are the stages of the reasoning cycle: perceive; select an intention; plan it; execute one
deed. The environment draws each percept anew, freely, at the start, at every action that is not
silent, and whenever the agent is idle, for ever. It changes nothing else.

AJPF's semantics: percepts that are drawn together are believed one after the other, those that
went first, and each change is a state of its own, which a property sees. A belief raises `+b` only
when it is new. Events become intentions, and intentions take turns, first come first served, one
deed a turn. A guard is asked when the event is planned; of the plans that fit, the first in the
file is taken; without one, the event is dropped.
Beyond AJPF: an agent perceives in one of two ways throughout a run. Either all changes
come before anything else is done; or each becomes an intention (unless the same one waits already),
with a turn of its own after those that wait. MCAPL has rules for both. Percepts that come at once,
or go at once, are believed in any order; and where a belief was both perceived and added by the
agent, losing one source may or may not take the other along, and may or may not raise an event. So
a property that holds here holds whichever way an implementation goes.

Sources: Dennis, Gwendolen semantics: 2017; Dennis et al., Model checking agent programming
languages, ASE 19 (2012); MCAPL's reasoning cycle and its environment for verification.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from enum import StrEnum
from itertools import chain, combinations, pairwise, permutations, product

from compiler.agents.gwendolen import Action, Agent, BeliefChange, Deed
from compiler.logic.kripke import Explored, explore
from fretish.classes.frozen import dataclass

SILENT = ("print", "remove_shared", "assert_shared")
"""Actions at which the environment draws nothing."""
Beliefs = frozenset[str]


class ReasoningStep(StrEnum):
    """What the agent does next."""

    BEGIN = "begin"
    PERCEIVE = "perceive"
    SELECT = "select"
    PLAN = "plan"
    EXECUTE = "execute"
    SLEEP = "sleep"


@dataclass(frozen=True, slots=True)
class Notice:
    """A perceived change of belief that the agent makes in a later turn."""

    change: BeliefChange

    def __str__(self) -> str:
        """The text of the notice as a deed."""
        return f"the percept {self.change}"


@dataclass(frozen=True, slots=True)
class Intention:
    """The deeds of the agent for an event, or for a percept."""

    event: BeliefChange | Notice
    deeds: tuple[Deed | Notice, ...] = ()
    """The deeds left; empty for an event until a plan is chosen."""


@dataclass(frozen=True, slots=True)
class AgentState:
    """The agent and its environment between two stages."""

    percepts: Beliefs
    """The percepts that the environment shows."""
    up_to_date: bool
    """Whether the agent has perceived `percepts` since the environment drew them."""
    perceived: Beliefs
    """Beliefs that come from percepts."""
    own: Beliefs
    """Beliefs that the agent added, or began with."""
    current: Intention | None
    waiting: tuple[Intention, ...]
    stage: ReasoningStep
    last: str | None
    """The last action that was not printing."""
    in_turn: bool = False
    """Whether each percept takes a turn of its own; chosen when the first are drawn."""

    @property
    def beliefs(self) -> Beliefs:
        """All beliefs, perceived and own."""
        return self.perceived | self.own


Step = tuple[str, AgentState]
"""An event in words, and the state after it."""


@dataclass(frozen=True, slots=True)
class Model:
    """The agent, and which percepts its environment draws."""

    agent: Agent
    percepts: tuple[str, ...]

    @property
    def initial(self) -> AgentState:
        """The state before the environment draws the first percepts."""
        own = frozenset(self.agent.beliefs)
        return AgentState(frozenset(), False, frozenset(), own, None, (), ReasoningStep.BEGIN, None)

    def steps(self, state: AgentState) -> Iterator[Step]:
        """Every possible next event with the state after it; at least one."""
        match state.stage:
            case ReasoningStep.BEGIN:
                yield from self._drawn(state)
                yield from self._drawn(replace(state, in_turn=True))
            case ReasoningStep.SLEEP:
                yield from self._drawn(state)
            case ReasoningStep.PERCEIVE:
                yield from _perceived(state)
            case ReasoningStep.SELECT:
                yield _selected(state)
            case ReasoningStep.PLAN:
                yield self._planned(state)
            case ReasoningStep.EXECUTE:
                yield from self._executed(state)

    def explored(self, limit: int) -> Explored[AgentState]:
        """All states, breadth first.

        Raises:
            ModelTooLargeError: there are more than the limit.
        """
        return explore(
            self.initial,
            lambda state: (following for _, following in self.steps(state)),
            self.label,
            limit,
        )

    def label(self, state: AgentState) -> frozenset[str]:
        """The atoms of AJPF's properties that are true; there are no goals, so no `G` and no `I`.

        A belief with a string in it matches no property.
        """
        name = self.agent.name
        intentions = [i for i in (state.current, *state.waiting) if i is not None]
        intended = {d.name for i in intentions for d in i.deeds if isinstance(d, Action)}
        done = () if state.last is None else (f"D({name},{state.last})",)
        atoms = (
            *(f"B({name},{belief})" for belief in state.beliefs),
            *(f"ItD({name},{action})" for action in intended),
            *done,
        )
        return frozenset(atom for atom in atoms if "'" not in atom)

    def _drawn(self, state: AgentState) -> Iterator[Step]:
        for percepts in self._draws():
            after = _with_percepts(state, percepts)
            stage = ReasoningStep.SLEEP if after.up_to_date else ReasoningStep.PERCEIVE
            yield f"the environment shows {_set(percepts)}", replace(after, stage=stage)

    def _draws(self) -> Iterator[Beliefs]:
        sizes = range(len(self.percepts) + 1)
        return map(frozenset, chain.from_iterable(combinations(self.percepts, n) for n in sizes))

    def _planned(self, state: AgentState) -> Step:
        intention = state.current
        assert intention is not None
        if intention.deeds:
            return "goes on", replace(state, stage=ReasoningStep.EXECUTE)
        for plan in self.agent.plans:
            fits = all((g.belief in state.beliefs) is g.positive for g in plan.guards)
            if plan.event != intention.event or not fits:
                continue
            if not plan.deeds:
                break
            chosen = replace(intention, deeds=plan.deeds)
            description = f"plans {intention.event}"
            return description, replace(state, current=chosen, stage=ReasoningStep.EXECUTE)
        description = f"drops {intention.event}: there is nothing to do"
        return description, replace(state, current=None, stage=ReasoningStep.PERCEIVE)

    def _executed(self, state: AgentState) -> Iterator[Step]:
        intention = state.current
        assert intention is not None
        deed, *rest = intention.deeds
        remaining = replace(intention, deeds=tuple(rest)) if rest else None
        after = replace(state, current=remaining, stage=ReasoningStep.PERCEIVE)
        match deed:
            case Action(name) if name.partition("(")[0] in SILENT:
                printing = name.partition("(")[0] == "print"
                yield f"does {name}", after if printing else replace(after, last=name)
            case Action(name):
                for percepts in self._draws():
                    description = f"does {name}; the environment shows {_set(percepts)}"
                    yield description, _with_percepts(replace(after, last=name), percepts)
            case Notice(change):
                words = "believes" if change.sign == "+" else "no longer believes"
                for state in _believed(after, change):
                    yield f"{words} {change.belief}", state
            case BeliefChange("+", belief):
                yield f"adds {belief}", _added(after, belief)
            case BeliefChange(_, belief):
                for state in _removed(after, belief):
                    yield f"removes {belief}", state


def _set(names: Beliefs) -> str:
    return ", ".join(sorted(names)) or "nothing"


def _with_percepts(state: AgentState, percepts: Beliefs) -> AgentState:
    """The state with newly drawn percepts; drawing none after none is no news for the agent."""
    up_to_date = state.up_to_date and not state.percepts and not percepts
    return replace(state, percepts=percepts, up_to_date=up_to_date)


def _perceived(state: AgentState) -> Iterator[Step]:
    """The next changes of beliefs: first those without a percept go, then new percepts come."""
    gone = [BeliefChange("-", belief) for belief in sorted(state.perceived - state.percepts)]
    come = [BeliefChange("+", belief) for belief in sorted(state.percepts - state.perceived)]
    done = replace(state, up_to_date=True, stage=ReasoningStep.SELECT)
    if state.up_to_date or not (gone or come):
        yield "perceives nothing new", done
    elif state.in_turn:
        for first, then in product(permutations(gone), permutations(come)):
            words = ", ".join(map(str, (*first, *then)))
            yield f"perceives {words}: one a turn", _noticed(done, (*first, *then))
    else:
        for change in gone or come:
            for after in _believed(state, change):
                yield f"perceives {change}", after


def _noticed(state: AgentState, changes: tuple[BeliefChange, ...]) -> AgentState:
    """One intention for each change, unless the same intention waits already."""
    intentions = (Intention(Notice(change), (Notice(change),)) for change in changes)
    new = [intention for intention in intentions if intention not in state.waiting]
    return replace(state, waiting=(*state.waiting, *new))


def _believed(state: AgentState, change: BeliefChange) -> tuple[AgentState, ...]:
    """One percept comes or goes; several outcomes where the agent has added the belief itself."""
    belief = {change.belief}
    if change.sign == "+":
        new = replace(state, perceived=state.perceived | belief)
        raised = _raised(new, change, 1)
        return (new, raised) if belief <= state.own else (raised,)
    if change.belief not in state.beliefs:
        return (state,)
    new = replace(state, perceived=state.perceived - belief)
    raised = _raised(new, change, 1)
    if not belief <= state.own:
        return (raised,)
    return new, raised, replace(raised, own=state.own - belief)


def _selected(state: AgentState) -> Step:
    queue = state.waiting if state.current is None else (*state.waiting, state.current)
    if not queue:
        return "falls asleep", replace(state, stage=ReasoningStep.SLEEP)
    after = replace(state, current=queue[0], waiting=queue[1:], stage=ReasoningStep.PLAN)
    return f"turns to {queue[0].event}", after


def _added(state: AgentState, belief: str) -> AgentState:
    after = replace(state, own=state.own | {belief})
    return after if belief in state.beliefs else _raised(after, BeliefChange("+", belief), 1)


def _removed(state: AgentState, belief: str) -> tuple[AgentState, ...]:
    """The agent removes a belief; several outcomes where the belief is also perceived."""
    gone = BeliefChange("-", belief)
    less = replace(state, own=state.own - {belief})
    neither = replace(less, perceived=state.perceived - {belief})
    if belief not in state.beliefs:
        return (state,)
    if belief in state.perceived and belief in state.own:
        return _raised(less, gone, 1), _raised(neither, gone, 1), _raised(neither, gone, 2)
    return (_raised(neither, gone, 1),)


def _raised(state: AgentState, event: BeliefChange, times: int) -> AgentState:
    return replace(state, waiting=(*state.waiting, *[Intention(event)] * times))


def narration(
    model: Model, explored: Explored[AgentState], numbers: tuple[int, ...]
) -> tuple[str, ...]:
    """The event before each state of a run, in words.

    Args:
        model: the model of the states.
        explored: all states of the model.
        numbers: the states of a run, from the initial state on.
    """
    actions = ["nothing yet"]
    for before, after in pairwise(numbers):
        wanted = explored.states[after]
        steps = model.steps(explored.states[before])
        actions.append(next(words for words, state in steps if state == wanted))
    return tuple(actions)
