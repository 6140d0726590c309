"""Constructors fold what is local and free: the meaning stays, at every tick."""

from collections.abc import Callable, Sequence

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.definition import holds
from tests import fret_notation as fret
from tests.strategies import (
    FORMULA_ATOMS,
    future_formulas,
    intervals,
    logic_formulas,
    past_formulas,
    traces,
)

Rows = list[dict[str, bool]]
a, b = f.Atom("a"), f.Atom("b")
NARROW = f.Interval(2, 3)


def folded(formula: f.Formula) -> f.Formula:
    """The same formula, from the leaves up through the constructors."""
    return f.rebuild(formula, folded)


def at_every_tick(formula: f.Formula, rows: Rows) -> list[bool]:
    return [holds(formula, rows, at) for at in range(len(rows))]


def endlessly(formula: f.Formula, rows: Rows, loop: int) -> list[int]:
    """On the infinite trace that goes back to `loop` after its last row."""
    word = {name: [int(row[name]) for row in rows] for name in FORMULA_ATOMS}
    return fret.values(fret.parse(printing.future(formula)), word, len(rows), loop=loop)


# Whole formulas -------------------------------------------------------------------------------


@given(past_formulas, traces(*FORMULA_ATOMS))
@example(f.Once(f.TRUE, NARROW), [{"a": True, "b": True}] * 4)
@example(f.Historically(f.FALSE, NARROW), [{"a": True, "b": True}] * 4)
@example(f.Since(f.FALSE, b, f.Interval(0, 2)), [{"a": True, "b": True}, {"a": True, "b": False}])
@example(f.Since(a, f.TRUE, NARROW), [{"a": True, "b": True}] * 4)
def test_folding_the_past_changes_no_tick(formula: f.Formula, rows: Rows) -> None:
    assert at_every_tick(folded(formula), rows) == at_every_tick(formula, rows)


@given(logic_formulas, traces(*FORMULA_ATOMS, max_size=3))
def test_folding_logic_changes_no_tick(formula: f.Formula, rows: Rows) -> None:
    assert at_every_tick(folded(formula), rows) == at_every_tick(formula, rows)


@given(future_formulas, traces(*FORMULA_ATOMS, max_size=5), st.data())
def test_folding_the_future_changes_no_tick_of_an_infinite_trace(
    formula: f.Formula, rows: Rows, data: st.DataObject
) -> None:
    loop = data.draw(st.integers(0, len(rows) - 1))
    assert endlessly(folded(formula), rows, loop) == endlessly(formula, rows, loop)


@given(future_formulas, traces(*FORMULA_ATOMS, max_size=5), st.data())
def test_folding_the_future_of_atoms_changes_no_tick_of_a_finite_trace(
    formula: f.Formula, rows: Rows, data: st.DataObject
) -> None:
    """Without constants: `X true` folds to true, but is false at the last tick of a finite trace.

    Formulas about finite traces guard such ticks by `LAST`.
    """
    plain = without_constants(formula)
    assert at_every_tick(folded(plain), rows) == at_every_tick(plain, rows)


def without_constants(formula: f.Formula) -> f.Formula:
    match formula:
        case f.Const(value):
            return a if value else b
        case f.Atom() | f.Last():
            return formula
        case f.And(args):
            return f.And(tuple(without_constants(arg) for arg in dict.fromkeys(args)))
        case f.Or(args):
            return f.Or(tuple(without_constants(arg) for arg in dict.fromkeys(args)))
        case f.Not(arg):
            return f.Not(without_constants(arg))
        case f.Next(arg):
            return f.Next(without_constants(arg))
        case f.Eventually(arg, ahead):
            return f.Eventually(without_constants(arg), ahead)
        case f.Globally(arg, ahead):
            return f.Globally(without_constants(arg), ahead)
        case f.Xor(left, right):
            # p xor p is no constant for the constructors; nothing is lost by naming it twice.
            return f.Xor(without_constants(left), without_constants(right))
        case f.Implies(left, right):
            return f.Implies(without_constants(left), without_constants(right))
        case f.Iff(left, right):
            return f.Iff(without_constants(left), without_constants(right))
        case f.Until(left, right):
            return f.Until(without_constants(left), without_constants(right))
        case f.Release(left, right):
            return f.Release(without_constants(left), without_constants(right))
        case _:
            raise AssertionError(formula)


# One constructor at a time --------------------------------------------------------------------

UNARY: dict[str, tuple[Callable[[f.Formula], f.Formula], Callable[[f.Formula], f.Formula]]] = {
    "not": (f.not_, f.Not),
    "previous": (f.previous, f.Previous),
    "weak_previous": (f.weak_previous, f.WeakPrevious),
}
BINARY: dict[
    str,
    tuple[Callable[[f.Formula, f.Formula], f.Formula], Callable[[f.Formula, f.Formula], f.Formula]],
] = {
    "xor": (f.xor, f.Xor),
    "implies": (f.implies, f.Implies),
    "iff": (f.iff, f.Iff),
    "and": (f.and_, lambda left, right: f.And((left, right))),
    "or": (f.or_, lambda left, right: f.Or((left, right))),
}
SMALL: Sequence[f.Formula] = (f.TRUE, f.FALSE, f.FIRST, f.Not(f.FIRST), a, f.Not(a), b)
WORD: Rows = [
    {"a": value & 1 == 1, "b": value & 2 == 2} for value in (0, 1, 3, 2, 0, 0, 1, 1, 3, 3, 2)
]


@pytest.mark.parametrize("name", UNARY)
def test_a_constructor_of_one_means_its_operator(name: str) -> None:
    build, operator = UNARY[name]
    for arg in SMALL:
        assert at_every_tick(build(arg), WORD) == at_every_tick(operator(arg), WORD), arg


@pytest.mark.parametrize("name", BINARY)
def test_a_constructor_of_two_means_its_operator(name: str) -> None:
    build, operator = BINARY[name]
    for left in SMALL:
        for right in SMALL:
            expected = at_every_tick(operator(left, right), WORD)
            assert at_every_tick(build(left, right), WORD) == expected, (left, right)


INTERVALS = [f.Interval(lo, hi) for lo in range(4) for hi in (*range(lo, lo + 3), None)]


@pytest.mark.slow
@pytest.mark.parametrize("ago", INTERVALS, ids=str)
def test_a_constructor_of_the_past_means_its_operator_in_every_window(ago: f.Interval) -> None:
    for left in SMALL:
        once, historically = f.Once(left, ago), f.Historically(left, ago)
        assert at_every_tick(f.once(left, ago), WORD) == at_every_tick(once, WORD), left
        assert at_every_tick(f.historically(left, ago), WORD) == at_every_tick(historically, WORD)
        for right in SMALL:
            since = f.Since(left, right, ago)
            assert at_every_tick(f.since(left, right, ago), WORD) == at_every_tick(since, WORD)


FUTURE: Sequence[f.Formula] = (f.TRUE, f.FALSE, a, f.Not(a), b)


@pytest.mark.slow
@pytest.mark.parametrize("ahead", INTERVALS, ids=str)
@pytest.mark.parametrize("loop", [0, 6, 10])
def test_a_constructor_of_the_future_means_its_operator(ahead: f.Interval, loop: int) -> None:
    for left in FUTURE:
        pairs: list[tuple[f.Formula, f.Formula]] = [
            (f.next_(left), f.Next(left)),
            (f.eventually(left, ahead), f.Eventually(left, ahead)),
            (f.globally(left, ahead), f.Globally(left, ahead)),
            *((f.until(left, right), f.Until(left, right)) for right in FUTURE),
            *((f.release(left, right), f.Release(left, right)) for right in FUTURE),
        ]
        for built, plain in pairs:
            assert endlessly(built, WORD, loop) == endlessly(plain, WORD, loop), plain


@given(intervals, intervals, traces(*FORMULA_ATOMS, max_size=4), st.data())
def test_a_disjunction_of_always_keeps_its_meaning(
    one: f.Interval, two: f.Interval, rows: Rows, data: st.DataObject
) -> None:
    loop = data.draw(st.integers(0, len(rows) - 1))
    args = (f.Globally(a, one), f.Globally(a, two), f.Globally(b, f.EVER))
    assert endlessly(f.or_(*args), rows, loop) == endlessly(f.Or(args), rows, loop)
    assert at_every_tick(f.or_(*args), rows) == at_every_tick(f.Or(args), rows)


# What is folded -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("built", "expected"),
    [
        (f.and_(), f.TRUE),
        (f.or_(), f.FALSE),
        (f.and_(a), a),
        (f.and_(a, f.and_(b, a)), f.And((a, b))),
        (f.or_(a, f.FALSE, f.or_(b, a)), f.Or((a, b))),
        (f.and_(a, f.FALSE), f.FALSE),
        (f.or_(a, f.TRUE), f.TRUE),
        (f.not_(f.not_(a)), a),
        (f.once(a, f.Interval(0, 0)), a),
        (f.once(f.TRUE), f.TRUE),
        (f.once(f.TRUE, NARROW), f.Once(f.TRUE, NARROW)),
        (f.historically(f.FALSE, NARROW), f.Historically(f.FALSE, NARROW)),
        (f.historically(f.FALSE), f.FALSE),
        (f.previous(f.TRUE), f.Previous(f.TRUE)),
        (f.weak_previous(f.FALSE), f.FIRST),
        (f.eventually(a, f.Interval(0, 0)), a),
        (f.globally(a, f.Interval(2, 2)), f.Globally(a, f.Interval(2, 2))),
        (f.until(f.TRUE, a), f.Eventually(a, f.EVER)),
        (f.release(f.FALSE, a), f.Globally(a, f.EVER)),
    ],
)
def test_a_constructor_folds_what_is_free(built: f.Formula, expected: f.Formula) -> None:
    assert built == expected


@pytest.mark.slow
@given(st.lists(logic_formulas, min_size=2, max_size=40))
def test_of_many_operands_each_stays_once_and_in_its_order(operands: list[f.Formula]) -> None:
    parts = [part for arg in operands for part in (arg.args if isinstance(arg, f.And) else (arg,))]
    once = [part for number, part in enumerate(parts) if part not in parts[:number]]
    expected = tuple(part for part in once if part != f.TRUE)
    built = f.and_(*operands)
    if f.FALSE in once:
        assert built == f.FALSE
    elif len(expected) > 1:
        assert built == f.And(expected)
    else:
        assert built == (expected[0] if expected else f.TRUE)


def test_without_an_end_last_is_false() -> None:
    finite = f.Release(f.LAST, f.Or((f.Not(a), f.Until(f.Not(f.LAST), b))))
    assert f.endless(finite) == f.Globally(f.Or((f.Not(a), f.Eventually(b, f.EVER))), f.EVER)


def test_atoms_come_in_their_order_and_once() -> None:
    formula = f.Implies(f.And((b, f.Not(a))), f.Since(b, f.Atom("c"), f.EVER))
    assert list(f.atoms(formula)) == ["b", "a", "c"]


@given(past_formulas)
def test_rebuilding_with_no_change_of_a_folded_formula_changes_nothing(formula: f.Formula) -> None:
    once = folded(formula)
    assert folded(once) == once
