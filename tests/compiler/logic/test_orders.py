"""What comparisons cannot be together, compared with numbers and against a circle search."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from operator import eq, ge, gt, le, lt, ne

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler.logic import orders
from compiler.logic.ordering import cells, ranges
from compiler.logic.orders import Exclusion, exclusions, only_possible
from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import TRUE, UNKNOWN, truth
from fretish import expressions as e
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import Sentence
from tests.calls import calls
from tests.effort import FULL

_COMPARE = {"<": lt, "<=": le, ">": gt, ">=": ge, "=": eq, "!=": ne}
_NAMES = ("x", "y", "z")
_CONSTANTS = ("0", "0.5", "2", "3")  # 32-bit floats have them


def read(text: str) -> e.Comparison:
    sentence = parse(Source("name", f"the c shall satisfy ({text})").span())
    assert isinstance(sentence, Sentence)
    assert isinstance(sentence.response, e.Comparison)
    return sentence.response


def of(*texts: str, **scales: Fraction) -> set[frozenset[tuple[str, bool]]]:
    return {frozenset(each) for each in exclusions({t: read(t) for t in texts}, scales)}


def valuations(texts: Sequence[str]) -> set[tuple[bool, ...]]:
    every = tuple(product((False, True), repeat=len(texts)))
    return {*only_possible(every, texts, exclusions({t: read(t) for t in texts}, {}))}


sides = st.sampled_from((*_NAMES, *_CONSTANTS))
texts = st.builds(
    lambda left, op, right: f"{left} {op} {right}",
    st.sampled_from(_NAMES),
    st.sampled_from(sorted(_COMPARE)),
    sides,
)
several = st.lists(texts, min_size=1, max_size=5, unique=True)


def value(text: str, numbers: Mapping[str, float]) -> bool:
    left, op, right = text.split()
    a, b = (numbers[t] if t in numbers else float(t) for t in (left, right))
    return bool(_COMPARE[op](a, b))


@pytest.mark.slow
@settings(max_examples=40 if FULL else 15)
@given(several)
def test_a_valuation_is_possible_where_numbers_make_it_and_nowhere_else(some: list[str]) -> None:
    """Every order of three numbers among the constants is one of those on a grid that fine."""
    grid = sorted({float(c) + k / 8 for c in _CONSTANTS for k in range(4)} | {-1.0, -0.5, -0.25})
    names = [name for name in _NAMES if any(name in text for text in some)]
    made = {
        tuple(value(text, dict(zip(names, numbers, strict=True))) for text in some)
        for numbers in product(grid, repeat=len(names))
    }
    assert valuations(some) == made


@pytest.mark.slow
@given(several)
def test_each_exclusion_is_a_least_one(some: list[str]) -> None:
    for exclusion in exclusions({text: read(text) for text in some}, {}):
        for one in exclusion:
            rest = [each for each in exclusion if each != one]
            possible = valuations([text for text, _ in rest])
            assert not rest or tuple(true for _, true in rest) in possible


def test_thresholds_of_one_signal_and_circles_of_several() -> None:
    assert of("x < 2", "x > 3") == {frozenset({("x < 2", True), ("x > 3", True)})}
    circle = ("x < y", "y < z", "z < x")
    assert of(*circle) == {frozenset((text, True) for text in circle)}
    assert of("x < x", "x <= x") == {frozenset({("x < x", True)}), frozenset({("x <= x", False)})}
    assert of("2 < 3", "x < 3") == {frozenset({("2 < 3", False)})}


def test_signs_and_magnitudes() -> None:
    assert of("-x > 3", "x > 1") == {frozenset({("-x > 3", True), ("x > 1", True)})}
    assert of("absReal(x) < 0.1", "x > 0.5", "x < -0.5") == {
        frozenset({("x > 0.5", True), ("x < -0.5", True)}),
        frozenset({("absReal(x) < 0.1", True), ("x > 0.5", True)}),
        frozenset({("absReal(x) < 0.1", True), ("x < -0.5", True)}),
    }


def test_what_is_computed_is_a_number_of_its_own() -> None:
    assert of("x + y < 3", "x + y > 5") == {frozenset({("x + y < 3", True), ("x + y > 5", True)})}
    assert not of("x + 1 <= x", "x < y")  # so it is of large floating-point numbers
    assert not of("x < 1e40", "x >= 2e40")  # both are infinite beside 32-bit floats


def test_words_of_an_enumerated_signal() -> None:
    operators: tuple[e.ComparisonOperator, ...] = ("=", "!=")
    compared = {
        f"mode {op} {word}": e.Comparison(op, e.Name("mode"), e.Word(word))
        for word in ("a", "b", "c")
        for op in operators
    }
    texts = tuple(compared)
    every = tuple(product((False, True), repeat=len(texts)))
    found = only_possible(every, texts, exclusions(compared, {}, {"mode": ("a", "b", "c")}))
    made = {
        tuple((mode == w) == (op == "=") for _, op, w in map(str.split, texts)) for mode in "abc"
    }
    assert {*found} == made
    more = only_possible(every, texts, exclusions(compared, {}, {"mode": ("a", "b", "c", "d")}))
    assert {*more} == made | {(False, True) * 3}


def test_signals_of_two_units_meet_as_they_are_converted() -> None:
    metres, kilometres = Fraction(1), Fraction(1000)
    assert of("x < y", "y < x", x=metres, y=kilometres)
    assert not of("x < y", "x < 1", "y > 2", x=metres, y=kilometres)


def test_nothing_is_left_out_where_nothing_would_be_left() -> None:
    every: tuple[tuple[bool, ...], ...] = ((False,), (True,))
    always: tuple[Exclusion, ...] = ((("p", True),), (("p", False),))
    assert only_possible(every, ["p"], always) == every
    assert only_possible(every, ["q"], always) == every


# Floating-point numbers: what is excluded of fractions must be excluded of samples, too

_FLOATS = ("0.1", "0.3", "0.30000000000000000001", "0.30000001", "16777217", "9007199254740993")
_TERMS = ("x", "y", "-x", "absReal(x)", "x + y", "x - y", "2 * x")
float_texts = st.builds(
    lambda left, op, right: f"{left} {op} {right}",
    st.sampled_from(_TERMS),
    st.sampled_from(sorted(_COMPARE)),
    st.sampled_from((*_TERMS, *_FLOATS)),
)
_KINDS = (np.float32, np.float64)


def samples(kind: type[np.floating]) -> np.ndarray[tuple[int], np.dtype[np.floating]]:
    """Numbers about the constants, on both sides, and infinities."""
    near = [kind(float(Fraction(text)) * sign) for text in _FLOATS for sign in (1, -1)]
    around = [np.nextafter(n, kind(end)) for n in near for end in (-np.inf, np.inf)]
    return np.array([*near, *around, 0, 1, np.inf, -np.inf], kind)


def as_bound(tree: e.Expression) -> e.Expression:
    match tree:
        case e.Call("absReal", args):
            return e.Call("abs", tuple(map(as_bound, args)))
        case e.Comparison(op, left, right):
            return e.Comparison(op, as_bound(left), as_bound(right))
        case _:
            return tree


@pytest.mark.slow
@example(["x >= 0.30000000000000000001", "x <= 0.3"], np.float64, np.float64)
@example(["x <= 0.3", "y > 0.3", "y <= x"], np.float32, np.float64)
@example(["x <= 16777217", "x >= 16777218"], np.float32, np.float32)
@given(
    st.lists(float_texts, min_size=2, max_size=5, unique=True),
    st.sampled_from(_KINDS),
    st.sampled_from(_KINDS),
)
def test_no_sample_of_an_audit_makes_what_is_excluded(
    some: list[str], first: type[np.floating], second: type[np.floating]
) -> None:
    x, y = samples(first), samples(second)
    numbers = {"x": np.repeat(x, len(y)), "y": np.tile(y, len(x))}
    scope = NameValues(len(x) * len(y), numbers)
    states = {text: truth(as_bound(read(text)), scope) for text in some}
    for exclusion in exclusions({text: read(text) for text in some}, {}):
        holds = np.ones(scope.length, bool)
        for text, true in exclusion:
            holds &= (states[text] == TRUE) == true
            holds &= states[text] != UNKNOWN
        assert not holds.any(), exclusion


@pytest.mark.slow
def test_a_cut_search_excludes_less_and_nothing_wrong() -> None:
    some = [f"x{i} < x{i + 1}" for i in range(14)]
    assert not of(*some)
    assert of(*some, "x14 < x0") <= {frozenset((t, True) for t in (*some, "x14 < x0"))}


def test_many_thresholds_take_as_many_exclusions() -> None:
    some = [f"x < {i}" for i in range(20)]
    found = _pairs(exclusions({text: read(text) for text in some}, {}))
    assert found == {(f"x < {i}", f"x < {i + 1}") for i in range(19)}


def _pairs(found: Iterable[Exclusion]) -> set[tuple[str, ...]]:
    return {tuple(text for text, _ in sorted(each, key=lambda one: not one[1])) for each in found}


# What it costs -------------------------------------------------------------------------------


def comparisons(shape: str, size: int) -> dict[str, e.Comparison]:
    return {text: read(text) for i in range(size) for text in SHAPES[shape](i)}


SHAPES: Mapping[str, Callable[[int], Sequence[str]]] = {
    "between": lambda i: (f"x < {i}", f"x > {i + 1}"),
    "inexact": lambda i: (f"x >= {i}.1", f"x != {i}.1"),
    "magnitude": lambda i: (f"absReal(x) < {i}",),
    "of signals of their own": lambda i: (f"x{i} < 3", f"x{i} > 5"),
}


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_more_thresholds_cost_in_proportion(shape: str) -> None:
    def cost(size: int) -> int:
        some = comparisons(shape, size)
        return calls(lambda: exclusions(some, {}))

    least, small, large = cost(20), cost(40), cost(80)
    assert large - small < 2.5 * (small - least)


@pytest.mark.parametrize(
    "some",
    [
        {**comparisons("between", 30), "x < y": read("x < y")},
        {f"{i}, {j}": read(f"x{i} < x{j}") for i in range(12) for j in range(i)},
    ],
    ids=["thresholds of two signals", "every pair"],
)
def test_a_search_that_ends_by_its_limit_excludes_nothing_else(
    some: Mapping[str, e.Comparison], monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(steps: int) -> set[Exclusion]:
        monkeypatch.setattr(orders, "MOST_STEPS", steps)
        return {*exclusions(some, {})}

    fewer, more = found(30_000), found(orders.MOST_STEPS)
    assert fewer <= more


@given(several, st.integers(0, 200))
def test_what_is_excluded_before_a_limit_is_impossible(some: list[str], steps: int) -> None:
    read_ = {text: read(text) for text in some}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(orders, "MOST_STEPS", steps)
        patch.setattr(ranges, "MOST_STEPS", steps // 10)
        patch.setattr(ranges, "MOST", steps)
        patch.setattr(orders, "MOST_POINTS", 6)
        cut = exclusions(read_, {})
    possible = valuations(some)
    assert {*only_possible(tuple(possible), some, cut)} == possible


@given(st.lists(st.text("01", min_size=4, max_size=4), min_size=1, max_size=16, unique=True))
def test_what_no_cell_has_is_excluded_and_nothing_else(columns: list[str]) -> None:
    made = cells.exclusions(columns, 1_000)
    every = tuple(
        tuple(map(bool, map(int, text))) for text in map("".join, product("01", repeat=4))
    )
    left = {
        values for values in every if not any(all(values[i] == v for i, v in ex) for ex in made)
    }
    assert left == {tuple(char == "1" for char in text) for text in columns}
    for each in made:
        for one in each:
            rest = {*each} - {one}
            assert any(all((text[i] == "1") == v for i, v in rest) for text in columns)


@pytest.mark.slow
def test_modes_exclude_one_another_in_pairs() -> None:
    words = tuple(f"m{i}" for i in range(60))
    compared = {word: e.Comparison("=", e.Name("mode"), e.Word(word)) for word in words}
    found = exclusions(compared, {}, {"mode": words})
    assert len(found) == 60 * 59 // 2 + 1
    assert {tuple(value for _, value in each) for each in found} == {(True, True), (False,) * 60}
