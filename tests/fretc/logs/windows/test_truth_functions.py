"""Functions in Python have the states that arrays have, for all kinds of numbers."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import outermost_persistences, truth
from fretc.logs.windows.truth_functions import NoFunctionError, NumberType, truth_function
from fretish import expressions as e
from fretish.bindings.functions import ROUNDED
from tests.effort import examples

NAN, INF = float("nan"), float("inf")
SINGLE, DOUBLE = np.dtype(np.float32), np.dtype(np.float64)
WORDS = ("idle", "docking", "lost")
SCALES = [Fraction(1), Fraction(1, 100), Fraction(1000), Fraction(254, 10000), Fraction(7, 3)]
DIGITS = ["0", "1", "0.9", "35", "0.1", "1e300", "9007199254740993", "5000000000000001", "1e-50"]
NUMBERS = [0.0, -0.0, 1.0, 0.9, 35.0, -35.0, 0.1, 1e300, -1e-300, 2.0**53, 2.0**52 + 1, NAN, INF]

names = st.sampled_from([e.Name("x"), e.Name("y"), e.Name("z")])
leaves = (
    names
    | st.builds(e.Number, st.sampled_from(DIGITS))
    | st.builds(e.Quantity, st.sampled_from(DIGITS), st.sampled_from(["m", "cm", "km"]))
)
terms = st.recursive(
    leaves,
    lambda inner: (
        st.builds(e.Negation, inner)
        | st.builds(e.Arithmetic, st.sampled_from(["+", "-", "*", "/", "mod"]), inner, inner)
        | st.builds(lambda x, n: e.Arithmetic("^", x, e.Number(n)), inner, st.sampled_from("123"))
        | st.builds(lambda x: e.Call("abs", (x,)), inner)
        | st.builds(
            lambda f, x: e.Call(f, tuple(x)),
            st.sampled_from(["min", "max"]),
            st.lists(inner, min_size=1, max_size=3),
        )
        | st.builds(e.Calculation, st.just("v"), inner, st.booleans())
        | st.sampled_from([*ROUNDED.items()]).flatmap(
            lambda each: st.builds(e.Call, st.just(each[0]), st.tuples(*[inner] * each[1].least))
        )
    ),
    max_leaves=4,
)
comparisons = st.builds(
    e.Comparison, st.sampled_from(["<", "<=", ">", ">=", "=", "!="]), terms, terms
)
words = st.builds(
    lambda op, word: e.Comparison(op, e.Name("mode"), e.Word(word)),
    st.sampled_from(["=", "!="]),
    st.sampled_from(WORDS),
)
held = st.builds(e.Persistence, st.just(e.Truth(True)), st.sampled_from([3, 5]))
expressions = st.recursive(
    comparisons | words | names | held | st.builds(e.Truth, st.booleans()),
    lambda inner: (
        st.builds(e.Not, inner)
        | st.builds(lambda all_: e.And(tuple(all_)), st.lists(inner, min_size=2, max_size=3))
        | st.builds(lambda all_: e.Or(tuple(all_)), st.lists(inner, min_size=2, max_size=3))
        | st.builds(e.Implies, inner, inner)
        | st.builds(e.Iff, inner, inner)
        | st.builds(e.Xor, inner, inner)
    ),
    max_leaves=4,
)
types = st.builds(NumberType, st.sampled_from([SINGLE, DOUBLE]), st.sampled_from(SCALES))
rows = st.lists(
    st.tuples(
        *[st.sampled_from(NUMBERS) | st.floats()] * 3,
        st.sampled_from([0.0, 1.0, 2.0, NAN]),
        st.integers(0, 2),
        st.integers(0, 2),
    ),
    min_size=1,
    max_size=8,
)
BOUND = e.Comparison("<", e.Name("x"), e.Number("0.9"))
"""0.9 as a 32-bit float is not below it."""
WHOLE = e.Comparison("<", e.Name("y"), e.Number("5000000000000001"))


@pytest.mark.slow
@example(BOUND, [NumberType(SINGLE)] * 3, [(float(np.float32(0.9)), 0.0, 0.0, 0.0, 0, 0)])
@example(WHOLE, [NumberType(DOUBLE)] * 3, [(0.0, 5000000000000000.0, 0.0, 0.0, 0, 0)])
@given(expressions, st.lists(types, min_size=3, max_size=3), rows)
@examples(120)
def test_the_states_are_those_of_arrays(
    expression: e.Expression,
    kinds: list[NumberType],
    some: list[tuple[float, float, float, float, int, int]],
) -> None:
    of = {**dict(zip("xyz", kinds, strict=True)), "mode": NumberType(DOUBLE, words=WORDS)}
    parts = tuple(dict.fromkeys(outermost_persistences(expression)))
    with np.errstate(all="ignore"):
        numbers = {
            name: np.array([row[i] for row in some], each.kind)
            for i, (name, each) in enumerate(of.items())
        }
        states = [[row[4 + i] for row in some] for i in range(len(parts))]
        scope = NameValues(
            len(some),
            numbers,
            scales={name: each.scale for name, each in of.items()},
            persistences={
                part: np.array(each, np.int8) for part, each in zip(parts, states, strict=True)
            },
            words={"mode": WORDS},
        )
        try:
            function = truth_function(expression, of, parts)
        except (NoFunctionError, ValueError):
            assume(False)
        columns = [each.astype(float).tolist() for each in numbers.values()]
        found = function(range(len(some)), *columns, *states)
        assert found == truth(expression, scope).tolist()


@pytest.mark.parametrize(
    "term",
    [
        e.Call("pre", (e.Number("1"), e.Name("x"))),
        e.Arithmetic("mod", e.Name("x"), e.Number("2")),
        e.Arithmetic("/", e.Number("1"), e.Number("0")),
    ],
)
def test_the_rest_is_left_to_arrays(term: e.Expression) -> None:
    with pytest.raises(NoFunctionError):
        truth_function(e.Comparison("<", term, e.Number("3")), {"x": NumberType(DOUBLE)})


def test_an_expression_too_deep_for_python_is_left_to_arrays() -> None:
    expression: e.Expression = e.Name("x")
    for _ in range(2400):
        expression = e.Not(expression)
    with pytest.raises(NoFunctionError):
        truth_function(expression, {"x": NumberType(DOUBLE)})
