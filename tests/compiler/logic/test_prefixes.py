"""Formulas of the future on prefixes: held against their definition on traces, and against Spot."""

from itertools import islice, product

import pytest
import spot
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.logic import prefixes, printing
from compiler.logic.definition import holds, holds_on_lasso
from compiler.logic.evaluation import evaluate
from compiler.logic.spot import deterministic_buchi
from fretish.diagnostics.source import Source
from fretish.expressions import Temporal
from fretish.formulas.reader import read
from tests.each import each
from tests.effort import FULL, examples
from tests.spot_monitors import Ltl3
from tests.strategies import logic, traces

A, B, C = f.Atom("a"), f.Atom("b"), f.Atom("c")
leaves = st.sampled_from([A, B, C, f.not_(A), f.not_(B)])


def _temporal(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    bounds = st.sampled_from([f.EVER, f.Interval(0, 2), f.Interval(1, 2)])
    return st.one_of(
        *logic(inner),
        st.builds(f.next_, inner),
        st.builds(f.eventually, inner, bounds),
        st.builds(f.globally, inner, bounds),
        st.builds(f.until, leaves, inner),
        st.builds(f.release, inner, leaves),
        st.builds(f.until, inner, inner),
    )


formulas: st.SearchStrategy[f.Formula] = st.recursive(leaves, _temporal, max_leaves=5)
Rows = list[dict[str, bool]]
ROWS = st.fixed_dictionaries(dict.fromkeys("abc", st.booleans()))


def columns(rows: Rows) -> dict[str, int]:
    return {
        name: sum(1 << tick for tick, row in enumerate(rows) if row[name])
        for name in ("a", "b", "c")
    }


def at_each_tick(formula: f.Formula, rows: Rows) -> list[bool]:
    value = evaluate(formula, columns(rows), len(rows))
    return [bool(value >> tick & 1) for tick in range(len(rows))]


@pytest.mark.slow
@examples(600)
@given(formulas, traces("a", "b", "c", max_size=6))
def test_a_trace_satisfies_the_finite_formula_unless_a_prefix_is_bad_or_it_ends_badly(
    formula: f.Formula, rows: Rows
) -> None:
    try:
        bad = at_each_tick(prefixes.bad_prefix(formula), rows)
        ended = at_each_tick(prefixes.ends_badly(formula, strict=False), rows)
        pending = at_each_tick(prefixes.ends_badly(formula, strict=True), rows)
    except prefixes.UntranslatableError:
        return
    for tick in range(len(rows)):
        trace = rows[: tick + 1]
        satisfied = not any(bad[: tick + 1]) and not ended[tick]
        assert holds(prefixes.finite(formula), trace) is satisfied
        # `X` and `F` are strong in the definition, `G` and `R` range over the ticks that exist.
        strict = holds(prefixes.negation_normal(formula), trace)
        if not _has_bounds(formula):
            assert pending[tick] is not strict


def _has_bounds(formula: f.Formula) -> bool:
    bounded = isinstance(formula, f.Eventually | f.Globally) and formula.ahead != f.EVER
    return bounded or any(map(_has_bounds, f.children(formula)))


@pytest.mark.slow
@examples(300)
@given(formulas, traces("a", "b", "c", max_size=6))
def test_a_bad_prefix_is_violated_for_certain_and_a_good_one_satisfied(
    formula: f.Formula, rows: Rows
) -> None:
    verdicts = Ltl3(formula).verdicts(rows)
    good = prefixes.good_prefix(formula)
    if good is not None:
        assert True not in at_each_tick(good, rows) or "satisfied" in verdicts
        for tick, value in enumerate(at_each_tick(good, rows)):
            assert not value or verdicts[tick] == "satisfied"
    try:
        bad = at_each_tick(prefixes.bad_prefix(formula), rows)
    except prefixes.UntranslatableError:
        return
    for tick, value in enumerate(bad):
        assert not value or verdicts[tick] == "violated"


@pytest.mark.slow
@examples(200)
@given(formulas)
def test_the_finite_formula_of_endless_traces_is_the_formula(formula: f.Formula) -> None:
    endless = f.endless(prefixes.finite(formula))
    assert spot.are_equivalent(printing.future(endless), printing.future(formula))


@pytest.mark.slow
@examples(150)
@given(formulas, st.lists(ROWS, max_size=3), st.lists(ROWS, min_size=1, max_size=3))
def test_the_deterministic_automaton_accepts_the_runs_of_the_formula(
    formula: f.Formula, prefix: Rows, loop: Rows
) -> None:
    automaton = deterministic_buchi(formula)
    if automaton is None:
        return
    state, visited = 0, []
    for row in (*prefix, *loop * (len(automaton.moves) + 1) * 2):
        targets = [
            target for condition, target in automaton.moves[state] if holds(condition, [row])
        ]
        if not targets:
            assert not holds_on_lasso(formula, prefix, loop)
            return
        (state,) = targets
        visited.append(state)
    late = visited[len(prefix) + len(loop) * (len(automaton.moves) + 1) :]
    accepted = automaton.accepting is None or not automaton.accepting.isdisjoint(late)
    assert accepted is holds_on_lasso(formula, prefix, loop)


SAFE = (
    "G (a -> X (b R c))", "G (a -> X b)", "G ((a & X !a) -> X (c | X c))", "a R b",
    "G (a -> (b R (c | b)))", "G !(a & X (b U (c & X a)))", "G (a -> G b)",
)  # fmt: skip


@pytest.mark.slow
def test_each_violation_of_a_safety_formula_is_reported_at_the_first_possible_tick() -> None:
    for text in SAFE:
        tree = read(Source("f", text).span())
        assert isinstance(tree, Temporal)
        formula = boolean(tree, Uninterpreted().alone())
        bad = prefixes.bad_prefix(formula)
        monitor = Ltl3(formula)
        for values in islice(product(range(8), repeat=4), None, None, 1 if FULL else 11):
            rows = [{"a": bool(v & 1), "b": bool(v & 2), "c": bool(v & 4)} for v in values]
            found = at_each_tick(bad, rows)
            verdicts = monitor.verdicts(rows)
            first = verdicts.index("violated") if "violated" in verdicts else None
            assert (found.index(True) if True in found else None) == first, (text, rows)


@each("formula", [f.globally(f.release(f.until(A, B), C)), f.eventually(A, f.Interval(0, 100))])
def test_what_has_no_formula_of_the_past_is_refused(formula: f.Formula) -> None:
    with pytest.raises(prefixes.UntranslatableError):
        prefixes.bad_prefix(formula)
