"""All runs of a graph against a formula: Spot's answer is compared with the definition."""

from collections.abc import Callable

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic.kripke import Kripke, Lasso, ModelTooLargeError, check, explore
from tests.lassos import keeps, lassos

p, q = f.Atom("B(a,p)"), f.Atom("B(a,q)")
P, Q, NONE, BOTH = (
    frozenset({p.name}),
    frozenset({q.name}),
    frozenset[str](),
    frozenset({p.name, q.name}),
)
RESPONSE = f.globally(f.implies(p, f.eventually(q)))


def formulas() -> st.SearchStrategy[f.Formula]:
    return st.recursive(
        st.sampled_from([p, q]),
        lambda parts: st.one_of(
            st.builds(f.not_, parts),
            st.builds(f.and_, parts, parts),
            st.builds(f.or_, parts, parts),
            st.builds(f.implies, parts, parts),
            st.builds(f.next_, parts),
            st.builds(f.eventually, parts),
            st.builds(f.globally, parts),
            st.builds(f.until, parts, parts),
            st.builds(f.release, parts, parts),
        ),
        max_leaves=4,
    )


@st.composite
def graphs(draw: st.DrawFn) -> Kripke:
    size = draw(st.integers(1, 3))
    labels = draw(st.lists(st.sampled_from([NONE, P, Q, BOTH]), min_size=size, max_size=size))
    states = st.lists(st.integers(0, size - 1), unique=True, max_size=2).map(tuple)
    edges = draw(st.lists(states, min_size=size, max_size=size))
    return Kripke(tuple(labels), tuple(edges), draw(st.integers(0, size - 1)))


@pytest.mark.slow
@given(graphs(), formulas())
@example(Kripke((P, Q), ((0, 1), ())), RESPONSE)
@example(Kripke((P,), ((),)), f.next_(f.next_(p)))
def test_a_counterexample_breaks_the_formula_and_without_one_every_run_keeps_it(
    kripke: Kripke, formula: f.Formula
) -> None:
    lasso = check(kripke, formula)
    if lasso is not None:
        assert not keeps(formula, kripke, lasso)
    else:
        assert all(keeps(formula, kripke, run) for run in lassos(kripke, 5))


def test_a_counterexample_is_a_run_as_short_as_may_be() -> None:
    ring = Kripke((NONE, NONE, P, NONE, Q), ((1, 2), (2,), (3,), (3, 4), (0,)))
    assert check(ring, RESPONSE) == Lasso((0, 2), (3,))
    assert check(ring, f.eventually(q)) == Lasso((0, 2), (3,))


def test_a_state_without_edges_is_repeated_for_ever() -> None:
    assert check(Kripke((P,), ((),)), f.globally(p)) is None
    assert check(Kripke((P,), ((),)), f.eventually(q)) == Lasso((), (0,))
    assert check(Kripke((NONE, P), ((1,), ())), f.eventually(f.globally(p))) is None


def test_an_atom_may_have_any_name_and_one_that_no_state_has_is_false() -> None:
    odd = f.Atom('a "quoted" (name')
    kripke = Kripke((frozenset({odd.name}),), ((0,),))
    assert check(kripke, f.globally(odd)) is None
    assert check(kripke, f.globally(f.not_(f.Atom("nowhere")))) is None
    assert check(kripke, f.eventually(f.Atom("true"))) == Lasso((), (0,))


def test_constants_are_formulas_too() -> None:
    kripke = Kripke((NONE,), ((0,),))
    assert check(kripke, f.TRUE) is None
    assert check(kripke, f.FALSE) == Lasso((), (0,))


@pytest.mark.parametrize("formula", [f.globally(f.LAST), f.ProbabilityBound(">=", "0.9", p)])
def test_what_is_not_about_single_endless_runs_is_not_checked(formula: f.Formula) -> None:
    with pytest.raises(ValueError, match="single endless runs"):
        check(Kripke((NONE,), ((0,),)), formula)


def counter(top: int) -> Kripke:
    return explore(
        0,
        lambda n: [n + 1, 0] if n < top else [],
        lambda n: P if n == top else NONE,
        limit=1000,
    ).kripke


def test_states_are_explored_breadth_first_and_edges_are_not_repeated() -> None:
    assert counter(2) == Kripke((NONE, NONE, P), ((1, 0), (2, 0), ()))
    assert explore(0, lambda n: [1, 1], lambda n: NONE, limit=2).kripke.edges == ((1,), (1,))


def test_there_is_a_limit_to_the_states() -> None:
    with pytest.raises(ModelTooLargeError, match="more than 1,000 states"):
        counter(1000)
    assert len(counter(999).labels) == 1000


def _way_to(kripke: Kripke, goal: Callable[[frozenset[str]], bool]) -> tuple[int, ...] | None:
    """A shortest path to a state whose atoms the goal accepts.

    The states go from the initial one to that state; None if no run reaches one.
    """
    came: dict[int, int | None] = {kripke.initial: None}
    waiting = [kripke.initial]
    for state in waiting:
        if goal(kripke.labels[state]):
            return _back(came, state)
        for following in kripke.successors(state):
            if following not in came:
                came[following] = state
                waiting.append(following)
    return None


def _back(came: dict[int, int | None], state: int | None) -> tuple[int, ...]:
    way: list[int] = []
    while state is not None:
        way.append(state)
        state = came[state]
    return tuple(reversed(way))


def test_the_way_to_a_state_is_a_shortest_one() -> None:
    ring = Kripke((NONE, NONE, P, Q), ((1, 2), (2,), (3,), (0,)))
    assert _way_to(ring, lambda label: p.name in label) == (0, 2)
    assert _way_to(ring, lambda label: q.name in label) == (0, 2, 3)
    assert _way_to(ring, lambda label: label == BOTH) is None
    assert _way_to(ring, lambda label: True) == (0,)


@settings(max_examples=20)
@given(graphs())
def test_an_invariant_is_kept_exactly_where_no_way_leads_to_its_breach(kripke: Kripke) -> None:
    invariant = check(kripke, f.globally(f.not_(p)))
    assert (invariant is None) == (_way_to(kripke, lambda label: p.name in label) is None)
