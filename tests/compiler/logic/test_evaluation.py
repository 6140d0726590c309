"""Formulas over whole traces and step by step, against their definition, tick by tick."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic.definition import holds
from compiler.logic.evaluation import evaluate, evaluate_unknown
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth, truth
from tests.effort import FULL
from tests.meaning import SCOPES
from tests.monitoring import monitor, of_formula, over, packed, requirement, steps
from tests.strategies import (
    few_templates,
    future,
    future_formulas,
    leaves,
    past,
    past_formulas,
    three_valued,
    traces,
)

Bits = list[bool]
Columns = Mapping[str, Sequence[bool]]


def number(values: Sequence[bool]) -> int:
    return sum(1 << i for i, value in enumerate(values) if value)


def numbers(columns: Columns) -> dict[str, int]:
    return {name: number(values) for name, values in columns.items()}


# The definition, in tables ----------------------------------------------------------------------


def table(formula: f.Formula, columns: Columns, ticks: int) -> Bits:
    """The truth at each tick, from the definition of each operator: no operator is rewritten."""

    def read(part: f.Formula) -> Bits:
        return table(part, columns, ticks)

    every = range(ticks)
    match formula:
        case f.Const(value):
            return [value] * ticks
        case f.Atom(name):
            return list(columns[name])
        case f.Last():
            return [i == ticks - 1 for i in every]
        case f.Not(arg):
            return [not value for value in read(arg)]
        case f.And(args):
            return [all(row) for row in zip(*map(read, args), strict=True)]
        case f.Or(args):
            return [any(row) for row in zip(*map(read, args), strict=True)]
        case f.Xor(left, right):
            return [a is not b for a, b in zip(read(left), read(right), strict=True)]
        case f.Implies(left, right):
            return [b or not a for a, b in zip(read(left), read(right), strict=True)]
        case f.Iff(left, right):
            return [a is b for a, b in zip(read(left), read(right), strict=True)]
        case f.Previous(arg) | f.WeakPrevious(arg):
            return [isinstance(formula, f.WeakPrevious), *read(arg)][:ticks]
        case f.Next(arg):
            return [*read(arg)[1:], False][:ticks]
        case f.Once(arg, ago):
            values = read(arg)
            return [any(values[slice(*_ago(ago, i))]) for i in every]
        case f.Historically(arg, ago):
            values = read(arg)
            return [all(values[slice(*_ago(ago, i))]) for i in every]
        case f.Eventually(arg, ahead):
            values = read(arg)
            return [any(values[slice(*_ahead(ahead, i, ticks))]) for i in every]
        case f.Globally(arg, ahead):
            values = read(arg)
            return [all(values[slice(*_ahead(ahead, i, ticks))]) for i in every]
        case f.Since(left, right, ago):
            kept, seen = read(left), read(right)
            return [_since(kept, seen, ago, i) for i in every]
        case f.Until(left, right):
            kept, seen = read(left), read(right)
            return [_until(kept, seen, i) for i in every]
        case f.Release(left, right):
            kept, seen = read(f.Not(left)), read(f.Not(right))
            return [not _until(kept, seen, i) for i in every]
        case _:
            raise AssertionError(formula)


def _ago(ago: f.Interval, at: int) -> tuple[int, int]:
    first = 0 if ago.hi is None else max(0, at - ago.hi)
    return first, max(0, at - ago.lo + 1)


def _ahead(ahead: f.Interval, at: int, ticks: int) -> tuple[int, int]:
    return at + ahead.lo, ticks if ahead.hi is None else at + ahead.hi + 1


def _since(kept: Bits, seen: Bits, ago: f.Interval, at: int) -> bool:
    """Back from the tick to a witness, as long as the left side has held after it."""
    oldest = 0 if ago.hi is None else max(0, at - ago.hi)
    for j in range(at, oldest - 1, -1):
        if seen[j] and at - j >= ago.lo:
            return True
        if not kept[j]:
            return False
    return False


def _until(kept: Bits, seen: Bits, at: int) -> bool:
    for j in range(at, len(seen)):
        if seen[j]:
            return True
        if not kept[j]:
            return False
    return False


@given(st.one_of(past_formulas, future_formulas), traces("a", "b"))
def test_the_tables_are_the_definition(formula: f.Formula, trace: list[dict[str, bool]]) -> None:
    columns = {name: [row[name] for row in trace] for name in ("a", "b")}
    found = table(formula, columns, len(trace))
    assert found == [holds(formula, trace, at) for at in range(len(trace))]


# Short traces -----------------------------------------------------------------------------------


@given(st.one_of(past_formulas, future_formulas), traces("a", "b"))
def test_a_column_is_the_truth_at_each_tick(
    formula: f.Formula, trace: list[dict[str, bool]]
) -> None:
    columns = {name: [row[name] for row in trace] for name in ("a", "b")}
    expected = [holds(formula, trace, at) for at in range(len(trace))]
    assert evaluate(formula, numbers(columns), len(trace)) == number(expected)


@given(st.one_of(past_formulas, future_formulas), three_valued("a", "b", max_size=5), st.data())
def test_what_is_told_of_unknown_atoms_holds_whatever_they_were(
    formula: f.Formula, trace: list[dict[str, bool | None]], data: st.DataObject
) -> None:
    _, columns = packed({name: [row[name] for row in trace] for name in ("a", "b")})
    truths = evaluate_unknown(formula, columns, len(trace))
    value = st.booleans()
    really = [{n: data.draw(value) if v is None else v for n, v in row.items()} for row in trace]
    for at in range(len(trace)):
        assert truths.at(at) in (None, holds(formula, really, at))
    if all(None not in row.values() for row in trace):
        assert truths.unknown == 0


def test_unknown_is_told_by_the_parts() -> None:
    _, columns = packed({"a": [None, True, False], "b": [True, None, False]})
    a, b = f.Atom("a"), f.Atom("b")
    truths = [
        [evaluate_unknown(formula, columns, 3).at(tick) for tick in range(3)]
        for formula in (
            f.Not(a),
            f.And((a, b)),
            f.Or((a, b)),
            f.Xor(a, b),
            f.Implies(a, b),
            f.Iff(a, b),
        )
    ]
    assert truths == [
        [None, False, True],
        [None, None, False],
        [True, True, False],
        [None, None, False],
        [True, None, True],
        [None, None, True],
    ]


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_the_future_at_the_first_tick_is_the_past_at_the_last(scope: str) -> None:
    """FRET's finite verdict by both of its formulas, and the monitor's, at every prefix."""
    choose = random.Random(scope)
    for template in few_templates((0, 2, 5)):
        if template.scope != scope:
            continue
        made, machine = requirement(template.sentence), monitor(template.sentence)
        columns = drawn(template.columns, 24, choose)
        outcome = steps(machine, columns)
        for ticks in range(1, 25):
            prefix = numbers({name: values[:ticks] for name, values in columns.items()})
            ahead = evaluate(made.ft_finite, prefix, ticks) & 1
            back = evaluate(made.pt, prefix, ticks) >> (ticks - 1) & 1
            assert ahead == back == outcome[ticks - 1].finite, (template, columns, ticks)


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_stepping_and_columns_agree_at_every_prefix(scope: str) -> None:
    """Also where some values are unknown."""
    choose = random.Random(scope)
    for template in few_templates((0, 2)):
        if template.scope != scope:
            continue
        machine = monitor(template.sentence)
        columns: dict[str, list[Truth]] = {
            name: [None if choose.random() < 0.04 else value for value in values]
            for name, values in drawn(template.columns, 24, choose).items()
        }
        for ticks, step in enumerate(steps(machine, columns), 1):
            outcome = over(machine, {name: values[:ticks] for name, values in columns.items()})
            found = (outcome.verdict, outcome.finite, outcome.first_violation)
            assert found == (step.verdict, step.finite, step.first_violation), (template, columns)


def drawn(names: Sequence[str], ticks: int, choose: random.Random) -> dict[str, list[bool]]:
    """Random columns, each with odds of its own."""
    odds = {name: choose.choice((0.1, 0.4, 0.9)) for name in names}
    return {name: [choose.random() < odds[name] for _ in range(ticks)] for name in names}


# Long traces, long bounds -----------------------------------------------------------------------

LONGEST, FARTHEST = 5_000, 1_000
intervals = st.one_of(
    st.just(f.EVER),
    st.builds(f.Interval, st.integers(0, FARTHEST), st.none()),
    st.tuples(st.integers(0, FARTHEST), st.integers(0, FARTHEST)).map(
        lambda pair: f.Interval(min(pair), max(pair))
    ),
)


def _past(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    return past(inner, intervals)


def _both_ways(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    return st.one_of(past(inner, intervals), future(inner, intervals))


long_past = st.recursive(leaves, _past, max_leaves=4)
long_mixed = st.recursive(leaves, _both_ways, max_leaves=4)


@st.composite
def long_traces(draw: st.DrawFn) -> dict[str, list[bool]]:
    """Columns with events that are rare or frequent, or come in long runs."""
    ticks = draw(st.sampled_from([1, 63, 64, 500, 1_500, LONGEST]))
    choose = draw(st.randoms(use_true_random=False))
    columns = {}
    for name in ("a", "b"):
        odds, run = choose.choice((0.001, 0.1, 0.5, 0.99)), choose.choice((1, 1, 40, 700))
        values = [choose.random() < odds for _ in range(ticks // run + 1)]
        columns[name] = [value for value in values for _ in range(run)][:ticks]
    return columns


slow = settings(max_examples=40 if FULL else 15, suppress_health_check=list(HealthCheck))


@pytest.mark.slow
@slow
@given(long_mixed, long_traces())
def test_nested_formulas_with_long_bounds_on_long_traces(
    formula: f.Formula, columns: dict[str, list[bool]]
) -> None:
    ticks = len(columns["a"])
    assert evaluate(formula, numbers(columns), ticks) == number(table(formula, columns, ticks))


@pytest.mark.slow
@slow
@given(long_past, long_traces())
def test_monitors_of_past_formulas_tell_them_at_each_tick(
    formula: f.Formula, columns: dict[str, list[bool]]
) -> None:
    """The formula and its negation; stepped, and over columns."""
    machine, ticks = of_formula(formula), len(columns["a"])
    expected = table(formula, columns, ticks)
    given = {name: columns[name] for name in machine.PROPOSITIONS}
    assert stepped(machine, given, ticks) == [(value, not value) for value in expected]
    _, made = packed(given) if given else (ticks, {})
    every = (1 << ticks) - 1
    literals = {
        name: made[proposition].true if positive else every ^ made[proposition].true
        for name, proposition, positive in machine.LITERALS
    }
    (signals,) = machine.columns(every, **literals)
    assert signals.trigger == number(expected)
    assert signals.answer == every ^ number(expected)


def stepped(
    machine: Monitor, columns: Mapping[str, Sequence[bool]], ticks: int
) -> list[tuple[Truth, Truth]]:
    """Trigger and answer after each tick."""
    found = []
    for tick in range(ticks):
        machine.advance([tuple(values[tick] for values in columns.values())])
        certain, possible = machine.certain.signals()[0], machine.possible.signals()[0]
        found.append(
            (truth(certain.trigger, possible.trigger), truth(certain.answer, possible.answer))
        )
    return found
