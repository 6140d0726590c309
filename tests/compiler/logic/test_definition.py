"""The definition of the operators on endless traces, against Spot's automata."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic.definition import holds_on_lasso
from tests.effort import examples
from tests.spot_oracle import holds_on

p, q = f.Atom("p"), f.Atom("q")
intervals = st.one_of(
    st.just(f.EVER),
    st.builds(lambda lo, more: f.Interval(lo, lo + more), st.integers(0, 3), st.integers(0, 3)),
    st.builds(lambda lo: f.Interval(lo, None), st.integers(0, 3)),
)
formulas = st.recursive(
    st.sampled_from([p, q, f.TRUE, f.FALSE]),
    lambda parts: st.one_of(
        st.builds(f.Not, parts),
        st.builds(lambda *args: f.And(args), parts, parts),
        st.builds(lambda *args: f.Or(args), parts, parts, parts),
        *(st.builds(kind, parts, parts) for kind in (f.Xor, f.Implies, f.Iff, f.Until, f.Release)),
        st.builds(f.Next, parts),
        *(st.builds(kind, parts, intervals) for kind in (f.Eventually, f.Globally)),
    ),
    max_leaves=5,
)
valuations = st.fixed_dictionaries({"p": st.booleans(), "q": st.booleans()})
NONE, P, Q = {"p": False, "q": False}, {"p": True, "q": False}, {"p": False, "q": True}


@examples(100)
@given(formulas, st.lists(valuations, max_size=4), st.lists(valuations, min_size=1, max_size=4))
@example(f.Release(q, p), [P, P], [P])
@example(f.Release(q, p), [P, {"p": True, "q": True}], [NONE])
@example(f.Until(p, q), [P, P], [P])
@example(f.Eventually(q, f.Interval(3, 3)), [], [NONE, Q])
@example(f.Globally(p, f.Interval(2, None)), [NONE, Q], [P])
def test_a_formula_holds_where_spot_says_so(
    formula: f.Formula, prefix: list[dict[str, bool]], loop: list[dict[str, bool]]
) -> None:
    assert holds_on_lasso(formula, prefix, loop) is holds_on(formula, prefix, loop)


def test_a_bound_may_be_far_longer_than_the_trace() -> None:
    """The loop comes round to `q` at all odd ticks."""
    odd = 10**12 + 1
    assert holds_on_lasso(f.Eventually(q, f.Interval(odd, odd)), [], [NONE, Q])
    assert not holds_on_lasso(f.Eventually(q, f.Interval(odd + 1, odd + 1)), [], [NONE, Q])
    assert holds_on_lasso(f.Globally(f.not_(p), f.Interval(0, odd)), [], [NONE, Q])


@pytest.mark.parametrize(
    "formula",
    [f.LAST, f.Once(p, f.EVER), f.Not(f.Previous(p)), f.ProbabilityBound(">=", "0.9", p)],
)
def test_what_is_not_about_the_future_of_an_endless_trace_is_refused(formula: f.Formula) -> None:
    with pytest.raises(ValueError, match="endless traces"):
        holds_on_lasso(formula, [], [P])
