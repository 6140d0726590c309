"""Shorter formulas: equivalent, never longer, and no bound is unrolled."""

import sys
from collections.abc import Iterator
from itertools import product
from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.spot import is_installed, same_language, simplified, unless_installed
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from tests.each import each
from tests.effort import examples, some
from tests.spot_oracle import equivalent, holds_on
from tests.strategies import quoted_texts

a, b = f.Atom("a"), f.Atom("b")
SCOPES = ("", "in m", "unless in m", "before m", "after m")
ONLY_SCOPES = ("only in m", "only before m", "only after m")
CONDITIONS = ("", "upon p", "whenever p")
TIMINGS = (
    *("", "immediately", "at the next timepoint", "finally", "eventually", "always", "never"),
    *("within 2 ticks", "for 2 ticks", "after 2 ticks", "until s", "before s"),
)


def sentences(scopes: tuple[str, ...]) -> Iterator[str]:
    for scope, condition, timing in product(scopes, CONDITIONS, TIMINGS):
        yield f"{scope} {condition} the sw shall {timing} satisfy q"


def formulas(sentence: str) -> tuple[f.Formula, f.Formula]:
    """On infinite and on finite traces."""
    ((entry,), _) = requirements(Source("r.fret", sentence))
    requirement, diagnostics = formalize(entry, None)
    assert requirement is not None, diagnostics
    return requirement.ft_infinite, requirement.ft_finite


def steps(text: str) -> int:
    """How many operators look at the next tick."""
    return text.replace("(", " ").replace("!", " ").split().count("X")


# Missing --------------------------------------------------------------------------------------


def test_a_package_of_the_same_name_is_not_spot(monkeypatch: pytest.MonkeyPatch) -> None:
    assert is_installed()
    monkeypatch.setitem(sys.modules, "spot", ModuleType("spot"))
    assert not is_installed()


def test_what_needs_spot_names_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    assert unless_installed("a proof needs") is None
    monkeypatch.setitem(sys.modules, "spot", None)
    missing = unless_installed("a proof needs")
    assert missing is not None
    assert render(missing) == (
        "F908 a proof needs Spot, which is not installed\n"
        "help: install Spot: `pip install spottl` on Linux x86-64 with CPython 3.11 to 3.13; on "
        "macOS and other Linux `conda install -c conda-forge spot` in the environment of fretc"
    )


# Equivalence ----------------------------------------------------------------------------------


def test_the_same_language_in_other_words_is_the_same() -> None:
    assert same_language("G(a -> F b)", "!F(a & G !b)")
    assert not same_language("G(a -> F b)", "G(a -> X F b)")


def test_what_is_no_formula_is_told() -> None:
    with pytest.raises(SyntaxError):
        same_language("G(a ->", "a")


def test_bounds_are_whole_ticks() -> None:
    bounded = f.Eventually(a, f.Interval(1, 2))
    assert equivalent(bounded, f.Or((f.Next(a), f.Next(f.Next(a)))))
    assert not equivalent(bounded, f.Eventually(a, f.Interval(0, 2)))


def test_the_last_tick_is_free_on_infinite_traces() -> None:
    assert not equivalent(f.LAST, f.FALSE)


@examples(10)
@given(st.lists(quoted_texts, min_size=2, max_size=2, unique=True))
def test_an_atom_of_any_text_is_an_atom(texts: list[str]) -> None:
    """Of quoted names, and of comparisons with words."""
    for spelling in ("{}", '(mode = "{}")'):
        first, second = (f.Atom(spelling.format(text)) for text in texts)
        response = f.globally(f.or_(f.not_(first), f.eventually(second)))
        assert holds_on(response, [{first.name: True}], [{second.name: True, first.name: False}])
        assert not holds_on(response, [], [{first.name: True, second.name: False}])
        assert not equivalent(first, second)
        assert equivalent(f.not_(f.or_(first, second)), f.and_(f.not_(first), f.not_(second)))
        bound = f.Eventually(f.Eventually(second, f.Interval(0, 90)), f.Interval(0, 90))
        shorter = simplified(f.and_(bound, f.eventually(f.eventually(first))))
        spelt = [printing.text(each, printing.SPOT) for each in (first, second)]
        assert shorter is None or all(text in shorter for text in spelt)


# Simplification -------------------------------------------------------------------------------


@pytest.mark.slow
@each("sentence", some([*sentences(SCOPES), *sentences(ONLY_SCOPES)], 5))
def test_a_simplified_formula_says_the_same_in_fewer_characters(sentence: str) -> None:
    for formula in formulas(sentence):
        text = simplified(formula)
        if text is not None:
            assert same_language(text, printing.future(formula))
            assert len(text) < len(printing.text(formula, printing.SPOT))


@pytest.mark.slow
def test_many_templates_do_have_a_shorter_formula() -> None:
    found = [simplified(formulas(sentence)[0]) for sentence in some(sentences(SCOPES), 4)]
    assert sum(text is not None for text in found) > len(found) / 6


def test_a_formula_that_is_short_already_has_none() -> None:
    assert simplified(f.Until(a, b)) is None


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (f.And((f.Globally(a, f.EVER), f.Globally(b, f.EVER))), "G(a & b)"),
        (f.Or((a, f.Next(f.Eventually(a, f.EVER)))), "Fa"),
        (f.Until(f.TRUE, f.Until(a, b)), "Fb"),
        (f.Globally(f.Globally(f.Eventually(a, f.EVER), f.EVER), f.EVER), "GFa"),
        (f.And((f.Eventually(a, f.Interval(0, 2)), f.Or((f.TRUE, b)))), "(F[0:2] a)"),
    ],
)
def test_a_formula_becomes_shorter(formula: f.Formula, text: str) -> None:
    assert simplified(formula) == text


# Bounds ---------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("timing", ["within", "for", "after"])
def test_a_long_bound_stays_one_operator(scope: str, timing: str) -> None:
    """3 000 operators would take Spot for ever: that this test ends is half of it."""
    for formula in formulas(f"{scope} upon p the sw shall {timing} 3000 ticks satisfy q"):
        text = simplified(formula) or printing.text(formula, printing.SPOT)
        assert ":3000]" in text
        assert len(text) < 1000
        assert steps(text) <= steps(printing.text(formula, printing.SPOT))


def twice_always(formula: f.Formula) -> f.Formula:
    """Something that Spot has a shorter word for."""
    return f.Globally(f.Globally(formula, f.EVER), f.EVER)


def test_the_same_long_bound_is_seen_to_be_the_same() -> None:
    soon = f.Eventually(a, f.Interval(0, 3000))
    assert simplified(f.And((soon, f.Or((soon, b))))) == "(F[0:3000] a)"


def test_a_long_bound_within_another_stays() -> None:
    inner = f.Globally(a, f.Interval(5, 4000))
    outer = f.Eventually(f.Or((inner, b)), f.Interval(0, 3000))
    text = simplified(f.And((outer, f.Globally(outer, f.EVER))))
    assert text == "G(F[0:3000]((G[5:4000] a) | b))"


def test_different_bounds_are_not_taken_for_each_other() -> None:
    sooner, later = (f.Eventually(a, f.Interval(0, n)) for n in (2000, 3000))
    text = simplified(f.And((twice_always(sooner), twice_always(later))))
    assert text == "G((F[0:2000] a) & (F[0:3000] a))"


def test_more_than_ten_bounds_keep_their_own() -> None:
    """The eleventh is not taken for the first with a digit more."""
    bounded = [f.Eventually(a, f.Interval(0, n)) for n in range(3000, 3012)]
    text = simplified(f.And(tuple(map(twice_always, bounded))))
    assert text is not None
    for n in range(3000, 3012):
        assert text.count(f"F[0:{n}] a") == 1
