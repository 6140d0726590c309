"""One formula in the spelling of each tool."""

import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.definition import holds
from compiler.logic.printing import DIALECTS, FRET, LATEX, NUSMV, PLAIN, SPOT
from compiler.logic.spot import same_language
from tests.each import each
from tests.monitoring import requirement

a, b, c = f.Atom("a"), f.Atom("b"), f.Atom("c")
FAST = f.Atom("(arm_x >= 3)")
ANSWER = f.Release(f.LAST, f.Implies(f.Atom("arm.x"), f.Eventually(FAST, f.Interval(0, 3))))
"""LAST R (arm.x -> F[0,3] arm_x >= 3): bounds, a comparison, a name to spell."""
SINCE = f.Not(f.Since(f.Xor(a, f.TRUE), f.Previous(b), f.Interval(1, 3)))
FIRST = f.Iff(f.Historically(f.And((a, f.Not(b))), f.EVER), f.Or((f.FIRST, f.Once(c, f.EVER))))


def test_there_are_five_dialects() -> None:
    assert list(DIALECTS) == ["plain", "fret", "spot", "nusmv", "latex"]


@pytest.mark.parametrize(
    ("dialect", "text"),
    [
        (PLAIN, "LAST R (arm_DOT_x -> F[0,3](arm_x >= 3))"),
        (FRET, "LAST V (arm_DOT_x -> F[0,3](arm_x >= 3))"),
        (SPOT, 'LAST R (arm_DOT_x -> F[0:3] "(arm_x >= 3)")'),
        (NUSMV, "LAST V (arm_DOT_x -> F [0,3](arm_x >= 3))"),
        (
            LATEX,
            r"\mathsf{LAST} \mathbin{\mathbf{R}} "
            r"(\mathit{arm\_DOT\_x} \rightarrow \mathbf{F}_{[0,3]}\,\mathit{(arm\_x \ge  3)})",
        ),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_an_answer_in_time(dialect: printing.Dialect, text: str) -> None:
    assert printing.text(ANSWER, dialect) == text


@pytest.mark.parametrize(
    ("dialect", "text"),
    [
        (PLAIN, "!((a xor TRUE) S[1,3] Y b)"),
        # b within the three ticks before, and a since then: without a bounded since.
        (FRET, "!(!a & O[1,1](!a S Y b & O[0,2] Y b))"),
        (SPOT, "!((a xor 1) S[1:3] Y b)"),
        (NUSMV, "!(!a & O [1,1](!a S Y b & O [0,2] Y b))"),
        (
            LATEX,
            r"\lnot ((\mathit{a} \oplus \top) \mathbin{\mathbf{S}}_{[1,3]} \mathbf{Y}\,\mathit{b})",
        ),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_bounded_since(dialect: printing.Dialect, text: str) -> None:
    assert printing.text(SINCE, dialect) == text


@pytest.mark.parametrize(
    ("dialect", "text"),
    [
        (PLAIN, "H(a & !b) <-> (Z FALSE) | O c"),
        (FRET, "H(a & !b) <-> (Z FALSE) | O c"),
        (SPOT, "H(a & !b) <-> (Z 0) | O c"),
        (NUSMV, "H(a & !b) <-> (Z FALSE) | O c"),
        (
            LATEX,
            r"\mathbf{H}(\mathit{a} \land \lnot \mathit{b}) \leftrightarrow "
            r"(\mathbf{Z}\,\bot) \lor \mathbf{O}\,\mathit{c}",
        ),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_first_tick(dialect: printing.Dialect, text: str) -> None:
    assert printing.text(FIRST, dialect) == text


# Names ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "sentence",
    [
        'the sw shall always satisfy "two words" > 3',
        'the sw shall always satisfy f("two words", p)',
        'the sw shall always satisfy "speed (m)"',
        'the sw shall always satisfy arm.x + 1 > load% & "a[3]"',
    ],
)
def test_a_name_in_quotes_is_one_proposition_to_spot(sentence: str) -> None:
    formula = requirement(sentence).ft_infinite
    assert same_language(printing.text(formula, SPOT), printing.future(formula))


@pytest.mark.parametrize("dialect", [FRET, NUSMV])
def test_a_name_in_quotes_is_spelt_without_them(dialect: printing.Dialect) -> None:
    """In formulas a space is `_SPC_`, a dot `_DOT_`: those tools have no quotes for a name."""
    formula = requirement('the sw shall always satisfy "two words" + arm.x > 3').ft_infinite
    assert printing.text(formula, dialect) == "G((two_SPC_words + arm_DOT_x) > 3)"


def test_a_name_that_ends_like_a_call_is_a_name() -> None:
    formula = requirement('the sw shall always satisfy "speed (m)"').ft_infinite
    assert re.fullmatch(r"G speed_SPC_\w+", printing.readable(formula))


def test_two_names_stay_two() -> None:
    formula = requirement('the sw shall always satisfy "a-b" & ! "a+b"').ft_infinite
    assert not same_language(printing.text(formula, SPOT), "0")


# Random formulas -----------------------------------------------------------------------------

leaves: st.SearchStrategy[f.Formula] = st.sampled_from([a, b, f.TRUE, f.FALSE])
bounds = st.one_of(
    st.just(f.EVER),
    st.builds(lambda lo: f.Interval(lo, None), st.integers(0, 2)),
    st.builds(lambda lo, more: f.Interval(lo, lo + more), st.integers(0, 3), st.integers(0, 3)),
)


def _logic(inner: st.SearchStrategy[f.Formula]) -> list[st.SearchStrategy[f.Formula]]:
    return [
        st.builds(f.Not, inner),
        st.builds(f.Xor, inner, inner),
        st.builds(f.Implies, inner, inner),
        st.builds(f.Iff, inner, inner),
        st.builds(f.And, st.tuples(inner, inner)),
        st.builds(f.Or, st.tuples(inner, inner, inner)),
    ]


def _past(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    return st.one_of(
        *_logic(inner),
        st.builds(f.Previous, inner),
        st.builds(f.WeakPrevious, inner),
        st.builds(f.Once, inner, bounds),
        st.builds(f.Historically, inner, bounds),
        st.builds(f.Since, inner, inner, bounds),
        st.builds(f.Since, inner, inner, bounds),
    )


def _future(inner: st.SearchStrategy[f.Formula]) -> st.SearchStrategy[f.Formula]:
    return st.one_of(
        *_logic(inner),
        st.builds(f.Next, inner),
        st.builds(f.Eventually, inner, bounds),
        st.builds(f.Globally, inner, bounds),
        st.builds(f.Until, inner, inner),
        st.builds(f.Release, inner, inner),
    )


past_formulas = st.recursive(leaves, _past, max_leaves=5)
future_formulas = st.recursive(leaves, _future, max_leaves=5)
traces = st.lists(st.fixed_dictionaries({"a": st.booleans(), "b": st.booleans()}), min_size=1)


@given(past_formulas, traces)
def test_a_bounded_since_is_said_by_other_operators(
    formula: f.Formula, trace: list[dict[str, bool]]
) -> None:
    spoken = printing.without_bounded_since(formula)
    for at in range(len(trace)):
        assert holds(spoken, trace, at) == holds(formula, trace, at)


@given(st.builds(f.Since, st.sampled_from([a, f.Not(a)]), st.just(b), bounds), traces)
def test_one_bounded_since_is_said_by_other_operators(
    formula: f.Formula, trace: list[dict[str, bool]]
) -> None:
    spoken = printing.without_bounded_since(formula)
    for at in range(len(trace)):
        assert holds(spoken, trace, at) == holds(formula, trace, at)


@given(past_formulas)
def test_fret_and_nusmv_get_no_bounded_since(formula: f.Formula) -> None:
    assert not re.search(r"\bS ?\[", printing.text(formula, FRET))
    assert not re.search(r"\bS ?\[", printing.text(formula, NUSMV))


@given(future_formulas)
def test_spot_reads_its_dialect_back(formula: f.Formula) -> None:
    assert same_language(printing.text(formula, SPOT), printing.future(formula))


PAIRS: tuple[Callable[[f.Formula, f.Formula], f.Formula], ...] = (
    *(f.Xor, f.Implies, f.Iff, f.Until, f.Release),
    lambda left, right: f.And((left, right)),
    lambda left, right: f.Or((left, right)),
    lambda left, right: f.Not(f.Next(f.Or((left, right)))),
    lambda left, right: f.Globally(f.Implies(left, right), f.Interval(1, 2)),
)


@each("outer", range(len(PAIRS)))
@each("inner", range(len(PAIRS)))
def test_spot_groups_two_operators_as_they_were(outer: int, inner: int) -> None:
    for formula in (
        PAIRS[outer](PAIRS[inner](a, b), c),
        PAIRS[outer](a, PAIRS[inner](b, c)),
    ):
        assert same_language(printing.text(formula, SPOT), printing.future(formula))


@given(st.one_of(past_formulas, future_formulas))
def test_latex_closes_every_brace(formula: f.Formula) -> None:
    assert balanced(printing.text(formula, LATEX))


@pytest.mark.parametrize("name", ["a{b", "a}b", "50%", "a_b", "a\\b", "a#b", "$x$", "{", "a & b"])
def test_latex_survives_any_name(name: str) -> None:
    for response in (f'"{name}"', f'"{name}" > 3', f'f("{name}")'):
        text = printing.text(
            requirement(f"the sw shall always satisfy {response}").ft_infinite, LATEX
        )
        assert balanced(text), text
        assert not re.search(r"(?<!\\)[#$%&~]|(?<!\\)_(?!\{)", text), text


def balanced(text: str) -> bool:
    """Whether every brace that is not escaped has its other half."""
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", text):
        depth += 1 if brace == "{" else -1
        if depth < 0:
            return False
    return depth == 0


def test_an_open_brace_is_seen() -> None:
    assert balanced(r"\mathit{a\{b}")
    assert not balanced(r"\mathit{a{b}")
    assert not balanced("}{")
