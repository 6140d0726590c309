"""The model of agents: what AJPF itself says of the same agents, and the steps one by one."""

from dataclasses import replace
from itertools import pairwise

import pytest

from compiler.agents.gwendolen import Agent, BeliefChange, read
from compiler.agents.model import AgentState, Intention, Model, ReasoningStep, narration
from compiler.logic import formula as f
from compiler.logic.kripke import Explored, ModelTooLargeError, check
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from tests.lassos import keeps

HEAD = "GWENDOLEN\n:name: ag\n:Initial Beliefs:{}\n:Initial Goals:\n:Plans:\n{}"
ONCE = "+near : {True} <- halt, +halted;"
RELEASED = f"{ONCE} -near : {{True}} <- release, -halted;"
GUARDED = "+near : {~B halted} <- halt, +halted; -near : {B halted} <- release, -halted;"
MUTANT = "+near : {True} <- halt; -near : {True} <- release, -halted;"


def belief(name: str) -> f.Formula:
    return f.Atom(f"B(ag,{name})")


NEAR, HALTED = belief("near"), belief("halted")
RESPONSE = f.globally(f.implies(NEAR, f.eventually(HALTED)))
AT_ONCE = f.globally(f.implies(NEAR, HALTED))
UNREACHED = f.globally(f.not_(NEAR))


def agent(plans: str, beliefs: str = "") -> Agent:
    found = read(Source("a.gwen", HEAD.format(beliefs, plans)))
    assert not isinstance(found, Diagnostic)
    return found


def explored(plans: str, *percepts: str, beliefs: str = "") -> tuple[Model, Explored[AgentState]]:
    model = Model(agent(plans, beliefs), percepts)
    return model, model.explored(10_000)


def holds(formula: f.Formula, plans: str, *percepts: str, beliefs: str = "") -> bool:
    _, found = explored(plans, *percepts, beliefs=beliefs)
    return check(found.kripke, formula) is None


@pytest.mark.parametrize(
    ("plans", "percept", "response", "at_once", "unreached"),
    [
        (ONCE, "near", True, False, False),
        (RELEASED, "near", True, False, False),
        (GUARDED, "near", False, False, False),
        (MUTANT, "near", False, False, False),
        # The environment that shows the response and never the trigger: all of it holds.
        (ONCE, "halted", True, True, True),
        (MUTANT, "halted", True, True, True),
    ],
)
def test_the_verdicts_are_those_of_ajpf(
    plans: str, percept: str, response: bool, at_once: bool, unreached: bool
) -> None:
    assert holds(RESPONSE, plans, percept) is response
    assert holds(AT_ONCE, plans, percept) is at_once
    assert holds(UNREACHED, plans, percept) is unreached


def test_the_counterexample_of_the_guards_is_a_run_of_the_model() -> None:
    model, found = explored(GUARDED, "near")
    lasso = check(found.kripke, RESPONSE)
    assert lasso is not None
    assert not keeps(RESPONSE, found.kripke, lasso)
    states = [found.states[n] for n in (*lasso.states, lasso.cycle[0])]
    assert states[0] == model.initial
    for before, after in pairwise(states):
        assert after in [state for _, state in model.steps(before)]
    actions = narration(model, found, lasso.states)
    lost = actions.index("drops +near: there is nothing to do")
    assert "does release; the environment shows near" in actions[:lost]
    assert "removes halted" in actions[lost:]
    assert not any(words.startswith("plans +near") for words in actions[lost : len(lasso.prefix)])


def first(words: str, steps: list[tuple[str, AgentState]]) -> AgentState:
    return next(state for action, state in steps if action == words)


def test_a_percept_becomes_an_event_a_plan_and_deeds_one_stage_each() -> None:
    model = Model(agent(RELEASED), ("near",))
    state = model.initial
    for action in (
        "the environment shows near",
        "perceives +near",
        "perceives nothing new",
        "turns to +near",
        "plans +near",
        "does halt; the environment shows near",
        "perceives nothing new",
        "turns to +near",
        "goes on",
        "adds halted",
        "perceives nothing new",
        "turns to +halted",
        "drops +halted: there is nothing to do",
        "perceives nothing new",
        "falls asleep",
        "the environment shows nothing",
        "perceives -near",
    ):
        state = first(action, list(model.steps(state)))
    assert model.label(state) == {"B(ag,halted)", "D(ag,halt)"}


def test_nothing_that_comes_from_a_percept_is_believed_at_the_start() -> None:
    assert not holds(NEAR, ONCE, "near")
    assert holds(f.not_(NEAR), ONCE, "near")


def test_initial_beliefs_are_there_from_the_start_and_raise_no_event() -> None:
    assert holds(f.globally(NEAR), ONCE, beliefs=" near")
    assert holds(f.globally(f.not_(HALTED)), ONCE, beliefs=" near")


def test_a_belief_that_is_there_already_raises_no_event() -> None:
    plans = "+near : {True} <- +halted; +halted : {True} <- alarm;"
    alarm = f.Atom("D(ag,alarm)")
    assert not holds(f.globally(f.not_(alarm)), plans, "near")
    assert holds(f.globally(f.not_(alarm)), plans, "near", beliefs=" halted")


def test_a_belief_that_is_not_there_is_removed_without_an_event() -> None:
    plans = "+near : {True} <- -halted; -halted : {True} <- alarm;"
    quiet = f.globally(f.not_(f.Atom("D(ag,alarm)")))
    assert holds(quiet, plans, "near")
    assert not holds(quiet, plans, "near", beliefs=" halted")


def test_the_first_plan_that_fits_is_taken() -> None:
    plans = "+near : {B halted} <- one; +near : {True} <- two; +near : {True} <- three;"
    assert holds(f.globally(f.not_(f.Atom("D(ag,one)"))), plans, "near")
    assert not holds(f.globally(f.not_(f.Atom("D(ag,two)"))), plans, "near")
    assert holds(f.globally(f.not_(f.Atom("D(ag,three)"))), plans, "near")


def test_the_last_action_stays_done_and_printing_is_none() -> None:
    plans = '+near : {True} <- halt, print("hello");'
    done = f.Atom("D(ag,halt)")
    assert holds(f.globally(f.implies(done, f.globally(done))), plans, "near")
    shared = "+near : {True} <- halt, assert_shared;"
    assert not holds(f.globally(f.implies(done, f.globally(done))), shared, "near")


def test_an_action_is_intended_from_its_plan_until_it_is_done() -> None:
    intended, done = f.Atom("ItD(ag,halt)"), f.Atom("D(ag,halt)")
    assert holds(f.release(intended, f.not_(done)), ONCE, "near")
    assert holds(f.globally(f.implies(intended, f.eventually(done))), ONCE, "near")
    assert not holds(f.globally(f.not_(intended)), ONCE, "near")


def test_there_are_no_goals_and_no_belief_has_a_string() -> None:
    model, found = explored('+near : {True} <- +said("hello"), +n(1);', "near")
    atoms = frozenset().union(*found.kripke.labels)
    assert atoms == {"B(ag,near)", "B(ag,n(1))"}
    assert model.agent.plans[0].deeds


def test_intentions_take_turns() -> None:
    """Two plans of two deeds: neither is finished before the other has begun."""
    plans = "+a : {True} <- +a1, +a2; +b : {True} <- +b1, +b2;"
    both_first = f.or_(
        f.not_(f.and_(belief("a"), belief("b"))),
        f.release(f.and_(belief("a1"), belief("b1")), f.not_(belief("a2"))),
    )
    start = f.globally(f.implies(f.and_(belief("a"), belief("b"), f.not_(belief("a1")),
                                        f.not_(belief("b1"))), both_first))  # fmt: skip
    assert holds(start, plans, "a", "b")


def events(state: AgentState) -> list[str]:
    return [str(intention.event) for intention in state.waiting]


def perceived(model: Model, state: AgentState) -> set[tuple[tuple[str, ...], ...]]:
    """What is believed on each way through perceiving, one set of names for each state."""
    if state.stage is not ReasoningStep.PERCEIVE:
        return {()}
    return {
        (tuple(sorted(after.beliefs)), *rest)
        for _, after in model.steps(state)
        for rest in perceived(model, after)
    }


def test_percepts_that_change_at_once_are_believed_one_after_the_other_in_any_order() -> None:
    model = Model(agent("+a : {True} <- +x;"), ("a", "b"))
    shown = first("the environment shows a, b", list(model.steps(model.initial)))
    both = ("a", "b")
    assert perceived(model, shown) == {(("a",), both, both), (("b",), both, both)}
    believed = replace(shown, percepts=frozenset(), perceived=frozenset("ab"))
    assert perceived(model, believed) == {(("a",), (), ()), (("b",), (), ())}


def test_what_went_comes_before_what_came() -> None:
    model = Model(agent(ONCE), ("a", "b"))
    state = replace(model.initial, percepts=frozenset("a"), perceived=frozenset("b"))
    assert perceived(model, replace(state, stage=ReasoningStep.PERCEIVE)) == {((), ("a",), ("a",))}


AFTER = ("perceives nothing new", "turns to +near", "plans +near")
"""What happens once the percept is believed."""


def test_an_agent_may_take_each_percept_in_a_turn_of_its_own() -> None:
    model = Model(agent(RELEASED), ("near",))
    begun = [s for words, s in model.steps(model.initial) if words.endswith("shows near")]
    (state,) = [state for state in begun if state.in_turn]
    for action in (
        "perceives +near: one a turn",
        "turns to the percept +near",
        "goes on",
        "believes near",
        "perceives nothing new",
        "turns to +near",
        "plans +near",
    ):
        assert ("B(ag,near)" in model.label(state)) is (action in AFTER)
        state = first(action, list(model.steps(state)))


def test_a_percept_that_waits_is_not_noticed_twice() -> None:
    model = Model(agent(ONCE), ("near",))
    near = frozenset({"near"})
    state = replace(model.initial, percepts=near, stage=ReasoningStep.PERCEIVE, in_turn=True)
    ((_, noticed),) = model.steps(state)
    assert events(noticed) == ["the percept +near"]
    again = replace(noticed, up_to_date=False, stage=ReasoningStep.PERCEIVE)
    ((_, still),) = model.steps(again)
    assert events(still) == ["the percept +near"]


def outcomes(model: Model, state: AgentState) -> set[tuple[frozenset[str], tuple[str, ...]]]:
    return {(after.beliefs, tuple(events(after))) for _, after in model.steps(state)}


def test_a_belief_of_two_sources_may_outlive_one_of_them_or_not() -> None:
    model = Model(agent("+go : {True} <- -near;", " near"), ("near",))
    near = frozenset({"near"})
    both = replace(model.initial, perceived=near, stage=ReasoningStep.PERCEIVE)
    assert outcomes(model, both) == {
        (near, ()),
        (near, ("-near",)),
        (frozenset(), ("-near",)),
    }
    removing = Intention(BeliefChange("+", "go"), (BeliefChange("-", "near"),))
    executing = replace(both, stage=ReasoningStep.EXECUTE, current=removing)
    assert outcomes(model, executing) == {
        (near, ("-near",)),
        (frozenset(), ("-near",)),
        (frozenset(), ("-near", "-near")),
    }
    owned = replace(model.initial, percepts=near, stage=ReasoningStep.PERCEIVE)
    assert outcomes(model, owned) == {(near, ()), (near, ("+near",))}


@pytest.mark.slow
def test_an_agent_with_too_much_to_do_has_too_many_states() -> None:
    """At each of its two actions comes another event: they are never all handled."""
    plans = "+near : {True} <- one, two; -near : {True} <- one, two;"
    with pytest.raises(ModelTooLargeError):
        explored(plans, "near")
