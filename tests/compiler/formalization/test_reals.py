"""Numbers make a valuation or they do not: compared with Fourier and Motzkin, and with a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, product
from operator import eq, ge, gt, le, lt, ne

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler.explanation.examples import examples
from compiler.explanation.explain import explanation
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import comparisons
from compiler.formalization.numbers.reals import (
    Impossible,
    Possible,
    Reals,
    Undecided,
    with_numeric_counterexample,
)
from compiler.logic.claims import ClaimResult
from compiler.logic.orders import Exclusion
from fretc.testing.generation import batch
from fretish.bindings.declarations import Variable
from tests.monitoring import emitted, requirement
from tests.proofs import verified

_COMPARE = {"<": lt, "<=": le, ">": gt, ">=": ge, "=": eq, "!=": ne}
_DENIED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "="}
_NAMES = ("x", "y", "z")
ROUNDED = "in exact arithmetic no numbers make `((2 * x) > 6)` and `(x < 2)`; rounded floats may"


@dataclass(frozen=True)
class Linear:
    """`a*x + b*y + c*z op limit`."""

    factors: tuple[int, ...]
    op: str
    limit: Fraction

    @property
    def text(self) -> str:
        terms = (f"{a} * {n}" for a, n in zip(self.factors, _NAMES, strict=False))
        return f"{' + '.join(terms).replace('+ -', '- ')} {self.op} {float(self.limit)}"

    def holds(self, numbers: Sequence[Fraction]) -> bool:
        total = sum((a * n for a, n in zip(self.factors, numbers, strict=True)), Fraction(0))
        return bool(_COMPARE[self.op](total, self.limit))


Bound = tuple[tuple[Fraction, ...], Fraction, bool]
"""Factors, limit, and whether the sum is less than it; else at most."""


def is_satisfiable(literals: Sequence[tuple[Linear, bool]]) -> bool:
    """By elimination of one variable after the other."""
    ways = [tuple(_bounds(each, value)) for each, value in literals]
    return any(_has_solution([bound for some in way for bound in some]) for way in product(*ways))


def _bounds(each: Linear, value: bool) -> Sequence[Sequence[Bound]]:
    """The ways to make it so."""
    op = each.op if value else _DENIED[each.op]
    up = tuple(map(Fraction, each.factors))
    down = tuple(-a for a in up)
    less, more = (up, each.limit, True), (down, -each.limit, True)
    match op:
        case "<":
            return [[less]]
        case ">":
            return [[more]]
        case "!=":
            return [[less], [more]]
        case _:
            sides = {"<=": [less], ">=": [more], "=": [less, more]}[op]
            return [[(factors, limit, False) for factors, limit, _ in sides]]


def _has_solution(bounds: Sequence[Bound]) -> bool:
    if not bounds or not bounds[0][0]:
        return all(limit > 0 or (limit == 0 and not strict) for _, limit, strict in bounds)
    upper = [bound for bound in bounds if bound[0][0] > 0]
    lower = [bound for bound in bounds if bound[0][0] < 0]
    rest = [(f[1:], limit, strict) for f, limit, strict in bounds if f[0] == 0]
    for (f, limit, strict), (g, other, is_strict) in product(upper, lower):
        factors = tuple(a / f[0] - b / g[0] for a, b in zip(f[1:], g[1:], strict=True))
        rest.append((factors, limit / f[0] - other / g[0], strict or is_strict))
    return _has_solution(rest)


def asked(some: Sequence[Linear]) -> tuple[FormalizedRequirement, dict[str, Linear]]:
    """A requirement that compares them, and which of its atoms each one is."""
    made = requirement(f"the sw shall satisfy {' | '.join(f'({each.text})' for each in some)}")
    names = comparisons(made)
    assert len(names) == len(some)
    return made, dict(zip(names, some, strict=True))


def linear(factors: int, least: int = -2) -> st.SearchStrategy[Linear]:
    return st.builds(
        Linear,
        st.tuples(*[st.integers(least, 3)] * factors),
        st.sampled_from(sorted(_COMPARE)),
        st.integers(-8, 8).map(lambda n: Fraction(n, 2)),
    )


def several(least: int, most: int) -> st.SearchStrategy[list[Linear]]:
    return st.integers(1, 3).flatmap(
        lambda n: st.lists(linear(n), min_size=least, max_size=most, unique_by=lambda e: e.text)
    )


@pytest.mark.slow
@settings(max_examples=15)
@given(several(1, 4))
def test_a_valuation_is_possible_where_elimination_says_so(some: list[Linear]) -> None:
    made, by_name = asked(some)
    reals = Reals(made)
    for values in product((False, True), repeat=len(some)):
        answer = reals.answer(dict(zip(by_name, values, strict=True)))
        assert answer != Undecided()
        literals = tuple(zip(some, values, strict=True))
        assert isinstance(answer, Possible) is is_satisfiable(literals)
        if isinstance(answer, Possible):
            numbers = [answer.numbers[name] for name in _NAMES[: len(some[0].factors)]]
            assert all(each.holds(numbers) is value for each, value in literals)
        else:
            assert isinstance(answer, Impossible)
            core = [(by_name[name], value) for name, value in answer.exclusion]
            assert not is_satisfiable(core)
            assert all(map(is_satisfiable, combinations(core, len(core) - 1)))


@pytest.mark.slow
@settings(max_examples=15)
@given(st.lists(linear(2, least=1), min_size=1, max_size=3, unique_by=lambda e: e.text))
@example([Linear((2, 2), "=", Fraction(1))])
@example([Linear((1, 1), ">", Fraction(0)), Linear((2, 2), "<", Fraction(2))])
def test_whole_numbers_are_those_of_a_grid(some: list[Linear]) -> None:
    """Natural ones, with positive factors: none beyond the grid compares in another way."""
    made, by_name = asked(some)
    glossary = {name: Variable(name, type="unsigned integer") for name in ("x", "y")}
    reals = Reals(replace(made, glossary=glossary))
    grid = {
        tuple(each.holds((Fraction(x), Fraction(y))) for each in some)
        for x, y in product(range(6), repeat=2)
    }
    for values in product((False, True), repeat=len(some)):
        answer = reals.answer(dict(zip(by_name, values, strict=True)))
        assert isinstance(answer, Possible) is (values in grid)


@pytest.mark.parametrize(
    ("texts", "answer"),
    [
        (("x * x < 0",), Impossible),
        (("x * x = 2",), Possible),
        (("x * y > 1", "x > 0", "y < 0"), Impossible),
        (("f(x) = 1", "x > 3"), Undecided),
        (("f(x) = 1", "2 * x > 6", "x < 2"), Impossible),
        (("f(x) = 1", "y > 3"), Possible),  # it may be any number
        (("x > 2 m", "x < 1 m"), Impossible),
        (("x > 2 m", "x < 3 m"), Possible),
    ],
)
def test_what_is_not_linear_is_decided_or_said_not_to_be(
    texts: Sequence[str], answer: type[Possible | Impossible | Undecided]
) -> None:
    made = requirement(f"the sw shall satisfy {' & '.join(texts)}")
    assert isinstance(Reals(made).answer(dict.fromkeys(comparisons(made), True)), answer)


def test_a_question_that_takes_too_long_is_not_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compiler.formalization.numbers.reals.MOST_QUESTIONS", 0)
    made = requirement("the sw shall satisfy 2 * x > 6 & x < 2")
    assert Reals(made).answer({}) == Undecided()
    found = explanation(made)
    assert (
        "it was not decided whether numbers can make these comparisons true and false in this way"
        in found.notes
    )


# What people see --------------------------------------------------------------------------------

SENTENCES = (
    "when {0} the sw shall within 2 ticks satisfy {1}",
    "whenever {0} & p the sw shall satisfy {1} | {2}",
    "the sw shall always satisfy {0} & {1}",
    "in m mode upon {0} the sw shall until {1} satisfy {2}",
)


@pytest.mark.slow
@settings(max_examples=12)
@given(several(3, 3), st.sampled_from(SENTENCES))
def test_numbers_make_every_trace_of_an_explanation(some: list[Linear], sentence: str) -> None:
    made = requirement(sentence.format(*(f"({each.text})" for each in some)))
    by_name = {name: each for each in some for name in comparisons(asked([each])[0])}
    found = examples(made)
    used = [name for name in by_name if name in found.atoms]
    assert len(used) >= 2
    assert not found.is_undecided
    for shown in (*found.satisfied, *found.violated):
        for row in (*shown.prefix, *shown.loop):
            values: Mapping[str, bool] = dict(zip(found.atoms, row, strict=True))
            assert is_satisfiable([(by_name[name], values[name]) for name in used])


def test_explanations_say_what_numbers_cannot_be() -> None:
    never = explanation(requirement("the sw shall always satisfy 2 * x > 6 & x < 2"))
    assert {each.satisfied for each in never.traces} == {False}
    assert never.notes[:2] == (
        ROUNDED,
        "no run that goes on satisfies the sentence, computed exactly",
    )
    other = explanation(requirement("the sw shall always satisfy 2 * x > 2 & x < 2"))
    assert {each.satisfied for each in other.traces} == {False, True}
    assert not any("computed" in note for note in other.notes)


ALWAYS = "the sw shall always satisfy "


def test_a_counterexample_has_numbers_where_another_one_serves() -> None:
    """The first valuation on which they differ is the one that no numbers make: neither is true."""
    wrong = ALWAYS + "(2 * x > 2 & x < 3) | (!(2 * x > 2) & !(x < 3))"
    outcome = verified(requirement(ALWAYS + "2 * x > 2 | x < 3"), emitted(wrong))
    assert outcome.result is ClaimResult.COUNTEREXAMPLE
    assert outcome.trace is not None
    assert outcome.trace.names == ("((2 * x) > 2)", "(x < 3)")
    assert (False, False) not in outcome.trace.rows
    assert "computed" not in outcome.detail


def test_a_monitor_that_differs_by_rounded_numbers_only_stays_refuted() -> None:
    wrong = ALWAYS + "!(2 * x > 6 & x < 2 & p)"
    outcome = verified(requirement(ALWAYS + "!(2 * x > 6 & x < 2)"), emitted(wrong))
    assert outcome.result is ClaimResult.COUNTEREXAMPLE
    assert outcome.detail.endswith(f"; no other trace was found that shows it, and {ROUNDED}")


@dataclass(frozen=True)
class Shown:
    """A trace of one tick."""

    word: tuple[tuple[bool, ...], ...]


@pytest.mark.slow
@settings(max_examples=12)
@given(several(2, 3), st.data())
def test_another_counterexample_is_shown_where_numbers_make_one_and_none_is_lost(
    some: list[Linear], data: st.DataObject
) -> None:
    made, by_name = asked(some)
    atoms, every = tuple(by_name), list(product((False, True), repeat=len(some)))
    faults = data.draw(st.lists(st.sampled_from(every), min_size=1, unique=True))

    def has(fault: tuple[bool, ...], excluded: Exclusion) -> bool:
        return all(fault[atoms.index(name)] is value for name, value in excluded)

    def compare(excluded: Sequence[Exclusion]) -> Shown | None:
        left = (fault for fault in faults if not any(has(fault, each) for each in excluded))
        return next((Shown((fault,)) for fault in left), None)

    found, note = with_numeric_counterexample(made, atoms, Shown, compare)
    assert isinstance(found, Shown)
    possible = [f for f in faults if is_satisfiable(tuple(zip(some, f, strict=True)))]
    assert found.word[0] == (possible or faults)[0]
    assert bool(note) is not bool(possible)
    assert with_numeric_counterexample(made, atoms, Shown, lambda _: None) == (None, "")


@pytest.mark.slow
def test_numbers_make_every_test_of_a_requirement() -> None:
    made = batch(requirement(SENTENCES[0].format("2 * x > 6", "x < 2")), (), 60)
    assert made.tests
    rows = [row.values for test in made.tests for row in test.rows]
    assert not any(row["((2 * x) > 6)"] and row["(x < 2)"] for row in rows)
